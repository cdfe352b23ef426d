#!/usr/bin/env bash
# Comparing pictures. Usage: cli_compare_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

"${run[@]}" --help | grep -q '^ *compare ' || { echo "skipped: this build does not compare pictures"; finish; }
pixels() { printf "P6\n4 3\n255\n" && printf "\\x$1%.0s" {1..36}; }
pixels 33 >a.ppm
pixels 66 >b.ppm

# Goal: figures of constant pictures are those of their levels; equal pictures have no error. Method: levels 51 and 102
# differ by 0.2.
expect closed_form 0 'RMSE 0\.200000, PSNR 13\.98 dB, largest difference 51 of 255; 12 of 12 pixels differ' compare a.ppm b.ppm
expect equal 0 'LIP 0\.000000 .*RMSE 0\.000000, PSNR infinite, largest difference 0 of 255; 0 of 12 pixels' compare a.ppm a.ppm
expect json 0 '"differing_pixels": 12' compare a.ppm b.ppm --json -
expect json_of_equal 0 '"psnr": null' compare a.ppm a.ppm --json -
"${run[@]}" compare a.ppm b.ppm --json - >figures.json
check json_alone test "$(head -c 1 figures.json)" = '{'

# Goal: --fail-above decides the exit status, and the figures are printed nevertheless.
expect within 0 'RMSE' compare a.ppm b.ppm --fail-above 1
expect equal_within_nothing 0 'RMSE' compare a.ppm a.ppm --fail-above 0
told=$("${run[@]}" compare a.ppm b.ppm --fail-above 0 -o beyond.png --json beyond.json 2>&1 >figures.txt)
check beyond test $? -eq 1
check beyond_is_told_in_one_line grep -qxE 'pocketray: b.ppm differs from a.ppm by ꟻLIP 0\.[0-9]+, more than --fail-above 0' <<<"$told"
check beyond_has_figures grep -q 'RMSE 0.2' figures.txt
check beyond_has_files test -s beyond.png -a -s beyond.json
for limit in nan inf -1 1.5 -nan x; do
  expect "fail_above_$limit" 1 'fail-above' compare a.ppm b.ppm "--fail-above=$limit"
done
for resolution in nan 0 -5 1e9; do
  expect "pixels_per_degree_$resolution" 1 'pixels-per-degree' compare a.ppm b.ppm "--pixels-per-degree=$resolution"
done

# Goal: the map has the pictures' size, black where they are equal. Method: its PNG header; the map of equal pictures
# compared with magma's first colour.
expect map 0 'RMSE' compare a.ppm b.ppm -o map.png
check map_size test "$(head -c 24 map.png | tail -c 8 | od -An -tx1 | tr -d ' \n')" = 0000000400000003
if "${run[@]}" render --help | grep -q glTF; then
  (printf 'P6 4 3 255\n' && printf '\0\0\4%.0s' {1..12}) >black.ppm
  "${run[@]}" compare a.ppm a.ppm -o black.png >/dev/null
  expect map_of_equal 0 ' 0 of 12 pixels differ' compare black.ppm black.png
  "${run[@]}" render cube --size 32x24 -o cube.ppm >/dev/null
  "${run[@]}" render cube --size 32x24 -o cube.png >/dev/null
  expect png_equals_ppm 0 'PSNR infinite' compare cube.ppm cube.png
  head -c 200 cube.png >cut.png
  expect truncated_png 1 'cut.png cannot be decoded' compare cube.ppm cut.png
  base64 -d >grey.jpg <<'J'
/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQERMUFRUVDA8XGBYUGBIU
FRT/wAALCAAIAAgBAREA/8QAFAABAAAAAAAAAAAAAAAAAAAAAP/EABQQAQAAAAAAAAAAAAAAAAAAAAD/2gAIAQEAAD8AP//Z
J
  (printf 'P6 8 8 255\n' && printf '\x80%.0s' {1..192}) >grey.ppm
  expect jpeg 0 'PSNR infinite' compare grey.ppm grey.jpg
  for count in 3 40 100 $(($(stat -c %s grey.jpg) - 2)); do
    head -c "$count" grey.jpg >cut.jpg
    expect "truncated_jpeg_$count" 1 'cut.jpg (cannot be decoded|is not a)' compare grey.ppm cut.jpg
  done
fi

# Goal: what cannot be compared is refused in one line, before anything is written.
pixels 33 | sed 's/^4 3$/3 4/' >turned.ppm
head -c 40 a.ppm >cut.ppm
: >empty.ppm
echo hello >text.png
mkdir folder.png
expect sizes 1 'a.ppm has 4×3 pixels, turned.ppm 3×4' compare a.ppm turned.ppm -o refused.png
expect absent 1 'none.png' compare a.ppm none.png -o refused.png
expect absent_reference 1 'none.png' compare none.png a.ppm -o refused.png
expect truncated_ppm 1 'cut.ppm is truncated' compare a.ppm cut.ppm -o refused.png
expect empty_picture 1 'empty.ppm' compare a.ppm empty.ppm -o refused.png
expect no_picture 1 'text.png is not a' compare a.ppm text.png -o refused.png
expect folder_as_picture 1 'folder.png' compare a.ppm folder.png -o refused.png
expect one_picture 2 'B is required' compare a.ppm
expect map_ending 1 'must end in .png' compare a.ppm b.ppm -o map.jpg
expect map_nowhere 1 'no/such/map.png' compare none.png b.ppm -o no/such/map.png
expect map_is_a_folder 1 'is a folder' compare none.png b.ppm -o folder.png
ln a.ppm linked.png
expect map_over_an_input 1 'linked.png would overwrite the input a.ppm of A' compare a.ppm b.ppm -o linked.png
expect json_over_an_input 1 'b.ppm would overwrite the input b.ppm of B' compare a.ppm b.ppm --json b.ppm
expect one_file_of_two 1 'name the same file' compare a.ppm b.ppm -o same.png --json same.png
check nothing_refused_is_written test ! -e refused.png

finish
