#!/usr/bin/env bash
# Parts of pictures. Usage: cli_crop_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

render() { "${run[@]}" render "$1" --size 32x24 --threads 2 -o "$2" "${@:3}" 2>&1; }
# cut FILE HEADER_BYTES PIXEL_BYTES : the pixels 5,3,17x9 of a picture of 32x24 whose rows run from the top.
cut_out() {
  local row
  for row in $(seq 3 11); do tail -c +$(($2 + 1 + (row * 32 + 5) * $3)) "$1" | head -c $((17 * $3)); done
}
crop=(--crop 5,3,17x9)

# Goal: the pixels of a crop equal those of the whole picture. Method: display levels, framebuffers with dither, and radiance
# (whose rows run from the bottom: 24 - 12 rows are below), with several samples, virtual lights in blocks of pixels, and an
# orthographic camera's rays one by one; AOVs; sequences.
for options in '' '--samples 4' '--indirect instant-radiosity' '--accel grid'; do
  read -ra more <<<"$options"
  render "$subject" whole.ppm ${more[@]+"${more[@]}"} >/dev/null
  render "$subject" part.ppm "${crop[@]}" ${more[@]+"${more[@]}"} >/dev/null
  check "crop_header_$options" test "$(head -n 2 part.ppm | tail -n 1)" = '17 9'
  check "crop_levels_$options" cmp -s <(tail -c +13 part.ppm) <(cut_out whole.ppm 13 3)
done
render "$subject" whole.raw --dither >/dev/null
render "$subject" part.raw --dither "${crop[@]}" >/dev/null
check crop_raw cmp -s part.raw <(cut_out whole.raw 0 2)
for aov in none depth normal triangle cost; do
  render "$subject" whole.pfm --aov $aov >/dev/null
  render "$subject" part.pfm --aov $aov "${crop[@]}" >/dev/null
  check "crop_radiance_$aov" cmp -s <(tail -c $((17 * 9 * 12)) part.pfm) \
    <(for row in $(seq 12 20); do tail -c +$(($(stat -c %s whole.pfm) - 24 * 32 * 12 + 1 + (row * 32 + 5) * 12)) whole.pfm | head -c $((17 * 12)); done)
done
render seesaw whole.ppm --frames 30:31 >/dev/null
expect crop_sequence 0 '17×9' render seesaw --size 32x24 --frames 30:31 "${crop[@]}" -o part.ppm
for n in 30 31; do check "crop_sequence_$n" cmp -s <(tail -c +13 part-00$n.ppm) <(cut_out whole-00$n.ppm 13 3); done
render "$subject" one.ppm --crop 31,23,1x1 >/dev/null
render "$subject" whole.ppm >/dev/null
check crop_of_the_last_pixel cmp -s <(tail -c 3 one.ppm) <(tail -c 3 whole.ppm)
render "$subject" all.ppm --crop 0,0,32x24 >/dev/null
check crop_of_everything cmp -s all.ppm whole.ppm
expect crop_gif 0 '3 frames at 30 per second, 17×9' render cube --size 32x24 --turntable 3 "${crop[@]}" -o part.gif
expect crop_png 0 '17×9' render cube --size 32x24 "${crop[@]}" -o part.png
check crop_png_size test "$(head -c 24 part.png | tail -c 8 | od -An -tx1 | tr -d ' \n')" = 0000001100000009

# Goal: only the crop is traced. Method: primary rays in the report.
primary() { "${run[@]}" render "$subject" --size 64x48 --json - -o counted.ppm "$@" 2>&1 | sed -n 's/.*"primary": \([0-9]*\).*/\1/p'; }
check crop_rays test "$(primary --crop 10,20,16x8)" = $((16 * 8))
check whole_rays test "$(primary)" = $((64 * 48))

# Goal: what makes no sense is refused in one line.
for text in 5,3,0x9 5,3,17x0 16,3,17x9 5,16,17x9 -1,3,4x4 5,3 5,3,17 5,3,17x9x 5,3,17X9 '5, 3,17x9' 99999999999,3,1x1 0,0,33x24; do
  expect "crop_$text" 1 "crop is '.*within the picture's 32x24 pixels" render cube --size 32x24 "--crop=$text" -o refused.ppm
done
expect crop_rotated 1 'drop --rotate' render cube --size 32x24 "${crop[@]}" --rotate 90 -o refused.raw
expect crop_budget 1 'drop --budget-ms' render cube --size 32x24 "${crop[@]}" --budget-ms 100 -o refused.ppm
expect crop_coherent 1 'drop --crop' render seesaw --size 32x24 "${crop[@]}" --frames 0:1 --coherence on -o refused.ppm
! "${run[@]}" render --help | grep -q -- '--server' ||
  expect crop_servers 1 'whole rows' render cube --size 32x24 "${crop[@]}" --server 127.0.0.1:1 -o refused.ppm
check nothing_refused_is_written test -z "$(find . -name 'refused*')"

finish
