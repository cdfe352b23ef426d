#!/usr/bin/env bash
# Accuracy sweeps. Usage: cli_accuracy_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: a sweep writes its table and its page, resumes where it was interrupted, and refuses another sweep's folder.
if "${run[@]}" --help | grep -q '^ *accuracy '; then
  tiny=(--size 16x12 --threads 2 --reference-samples 2)
  expect accuracy_without_folder 2 'needs --output DIR' accuracy cube
  expect accuracy_output 1 'rgb565-dithered' accuracy cube "${tiny[@]}" -o sweep --pixel-format vga
  expect accuracy_reference 1 'model, physical or a file' accuracy cube "${tiny[@]}" -o sweep --reference best
  expect accuracy_folder 1 'no/such' accuracy cube "${tiny[@]}" -o no/such/folder
  "${run[@]}" accuracy cube "${tiny[@]}" -o sweep --rounds 1000 >/dev/null 2>interrupted.err &
  sweeping=$!
  wait_for $sweeping grep -qs '"rounds": [1-9]' sweep/accuracy.state
  kill -INT $sweeping
  wait $sweeping
  check accuracy_is_interrupted test $? -eq 3
  check accuracy_says_that_it_is_kept grep -q 'so far are in sweep.*same command' interrupted.err
  expect accuracy 0 'index.html for the results' accuracy cube "${tiny[@]}" -o sweep --rounds 1 --json sweep.json
  if ! grep -q '"instructions_per_pixel": [1-9]' sweep.json; then
    check accuracy_offers_to_count grep -q 'count-instructions lets valgrind' sweep.json
  fi
  counting=("${tiny[@]}" --count-instructions)
  expect accuracy_that_counts 0 'index.html for the results' accuracy cube "${counting[@]}" -o sweep --rounds 1
  check accuracy_table grep -q '^samples,16,[0-9]' sweep/accuracy.csv
  check accuracy_json grep -q '"flip_truth": 0' sweep.json
  check accuracy_page grep -q '</html>' sweep/index.html
  # Goal: a scene that stores radiosity is swept by every method of indirect light and every reconstruction.
  expect bake_lit 0 'patches' bake cube --radiosity -o lit.pray
  # Goal: fewer patches store less; their number asks for radiosity and has limits.
  expect bake_with_few_patches 0 'radiosity: [0-9]{2,3} patches' bake cube --radiosity --patches 60 -o few.pray
  check few_patches_store_less test "$(stat -c %s few.pray)" -lt $(($(stat -c %s lit.pray) / 4))
  expect patches_without_radiosity 1 'patches applies to --radiosity' bake cube --patches 60 -o few.pray
  expect patches_beyond_limits 1 'it must lie in 20 … 5000' bake cube --radiosity --patches 9 -o few.pray
  expect accuracy_of_lit 0 'index.html for the results' accuracy lit.pray "${tiny[@]}" -o lit --rounds 1
  for method in none ambient radiosity instant-radiosity; do
    check "accuracy_has_$method" grep -q "^several,.*,$method\$" lit/accuracy.csv
  done
  check accuracy_has_smooth_light grep -q '^reconstruction,cubic,[0-9]' lit/accuracy.csv
  # Goal: choices of bake are measured on request, with what they store.
  if [ $# -eq 0 ]; then  # emulated, radiosity of many patches takes minutes
    expect accuracy_of_bakes 0 'bakes the scene 4 times, about .* s of which are for radiosity' accuracy cube "${tiny[@]}" \
      -o bakes --rounds 1 --bake-choices --json bakes.json
    check accuracy_has_bakes grep -q '^radiosity,75 patches,[0-9].*,[0-9]*,[0-9.e-]*,radiosity$' bakes/accuracy.csv
    "${run[@]}" bake cube --no-radiosity -o plain.pray >/dev/null
    expect accuracy_of_unlit 0 'index.html' accuracy plain.pray "${tiny[@]}" -o plain --rounds 1 --json plain.json
    check accuracy_predicts_radiosity grep -q '"flip_truth_without": 0' plain.json
    expect accuracy_of_other_bakes 1 'bake-choices.*--restart' accuracy cube "${tiny[@]}" -o bakes --rounds 1
  fi
  # Goal: instructions are counted if possible; otherwise nothing else is lost. Method: the baseline's row; if the CPU does
  # not count them, a valgrind that fails, one that is interrupted, and a program without symbols. Skipped if valgrind is not
  # installed or cannot run this program (an emulated CPU, a sanitizer).
  counts() { awk -F, '$1 == "baseline" && $18 > 100 { found = 1 } END { exit !found }' "$1/accuracy.csv"; }
  if [ $# -eq 0 ] && valgrind -q "$program" --version >/dev/null 2>&1; then
    check accuracy_counts counts sweep
    mkdir fake
    printf '#!/bin/sh\nexit 1\n' >fake/valgrind
    chmod +x fake/valgrind
    real_path=$PATH PATH=$PWD/fake:$PATH
    expect accuracy_failing_valgrind 0 'index.html for the results' accuracy cube "${counting[@]}" -o other --rounds 1 --json other.json
    if ! counts other; then
      check accuracy_tells_that_valgrind_failed grep -q 'not counted: .* valgrind failed' other.json
      cp sweep/accuracy.state counted.state
      expect accuracy_counts_once 0 'by valgrind over the picture, one thread, [a-z0-9]+' accuracy cube "${counting[@]}" -o sweep --rounds 1
      check accuracy_keeps_counts cmp -s sweep/accuracy.state counted.state
      printf '#!/bin/sh\necho $$ >fake.id.part && mv fake.id.part fake.id\nexec sleep 60\n' >fake/valgrind
      "${run[@]}" accuracy cube "${counting[@]}" -o other --rounds 1 >/dev/null 2>&1 &
      sweeping=$!
      wait_for $sweeping test -s fake.id
      kill -INT $sweeping
      wait $sweeping
      check accuracy_is_interrupted_when_counting test $? -eq 3
      check accuracy_ends_valgrind test ! -e "/proc/$(cat fake.id)"
      PATH=$real_path
      expect accuracy_counts_after_all 0 'by valgrind over the picture' accuracy cube "${counting[@]}" -o other --rounds 1
      if strip -o stripped "$program" 2>/dev/null; then
        run=("$PWD/stripped")
        expect accuracy_without_symbols 0 'not counted: .* no symbols' accuracy cube "${counting[@]}" -o third --rounds 1
        run=("$program")
      fi
    fi
    PATH=$real_path
  else
    echo "skipped: valgrind is not installed or cannot run $program"
  fi
  expect accuracy_other_samples 1 'samples.*--restart' accuracy cube "${counting[@]}" -o sweep --samples 2
  echo nonsense >sweep/accuracy.state
  expect accuracy_damaged 1 'damaged.*--restart' accuracy cube "${counting[@]}" -o sweep
fi

finish
