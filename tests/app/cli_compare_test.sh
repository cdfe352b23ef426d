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

# Goal: PFM pictures are compared in linear light and as displayed. Method: constant pictures of radiance 0.5 and 0.25,
# one with the other order of bytes: relative MSE .0625 / (.25 + .01), scale 2; what `render` and `reference` write.
(printf 'PF\n4 3\n-1.0\n' && printf '\0\0\0\x3f%.0s' {1..36}) >half.pfm
(printf 'PF 4 3 1 ' && printf '\x3e\x80\0\0%.0s' {1..36}) >quarter.pfm
expect linear 0 'linear light: RMSE 0\.25, relative MSE 0\.240385, bias -0\.25, largest difference 0\.25' compare half.pfm quarter.pfm
expect linear_displayed 0 'RMSE 0\.198[0-9]+, .*12 of 12 pixels differ' compare half.pfm quarter.pfm
expect white 0 'exposure × 1 \(\+0\.000 stops\), as displayed' compare half.pfm quarter.pfm
expect aligned 0 'aligned: B × 2 \(\+1\.000 stops\)' compare half.pfm quarter.pfm --align
expect aligned_equal 0 'PSNR infinite' compare half.pfm quarter.pfm --align
expect stops 0 'exposure × 0\.5 \(-1' compare half.pfm quarter.pfm --exposure=-1
expect middle_grey 0 'exposure × 0\.36 ' compare half.pfm quarter.pfm --exposure auto
expect linear_json 0 '"aligned_scale": 2\.0' compare half.pfm quarter.pfm --align --json -
expect levels_json 0 '"linear": null' compare a.ppm b.ppm --json -
told=$("${run[@]}" compare half.pfm quarter.pfm --fail-above 0 2>&1 >/dev/null)
check linear_beyond grep -q 'more than --fail-above 0' <<<"$told"
"${run[@]}" render cube --size 32x24 -o cube.pfm >/dev/null
"${run[@]}" render cube --size 32x24 -o cube.ppm >/dev/null
expect rendered 0 'PSNR infinite.* 0 of 768 pixels' compare cube.pfm cube.pfm --map linear.png
check linear_map test "$(head -c 24 linear.png | tail -c 8 | od -An -tx1 | tr -d ' \n')" = 0000002000000018
expect displayed_is_the_light 0 'PSNR infinite' compare cube.ppm cube.pfm
expect light_is_the_displayed 0 'PSNR infinite' compare cube.pfm cube.ppm
"${run[@]}" render cube --size 32x24 --exposure 2 --tone film -o film.ppm >/dev/null
"${run[@]}" render cube --size 32x24 --exposure 2 --tone film -o film.pfm >/dev/null
expect film_is_the_light 0 'PSNR infinite' compare film.ppm film.pfm --exposure 2 --tone film
expect film_is_not_clipped 0 ' [1-9][0-9]* of 768 pixels differ' compare film.ppm film.pfm --exposure 2
expect film_of_linear_light 0 'PSNR infinite' compare film.pfm cube.pfm --exposure 2 --tone film
expect exposure_of_film_is_found 0 'aligned: exposure × (4 |4\.0|3\.9)' compare film.ppm film.pfm --align --tone film
expect tone_of_levels 1 '--tone changes linear light' compare a.ppm b.ppm --tone film
expect exposure_is_found 0 'aligned: exposure × (1 |1\.00|0\.99)' compare cube.ppm cube.pfm --align
"${run[@]}" reference cube --size 32x24 --samples 16 -o reference.pfm >/dev/null
expect reference 0 'linear light: RMSE 0\.' compare reference.pfm cube.pfm --align
expect reference_beside_levels 0 'as displayed' compare reference.pfm cube.ppm
if "${run[@]}" render cube --size 32x24 -o cube.exr >/dev/null 2>&1; then
  expect exr 0 'PSNR infinite.* 0 of 768 pixels' compare cube.pfm cube.exr
  head -c 500 cube.exr >cut.exr
  expect truncated_exr 1 'cut.exr (is truncated|cannot be decoded)' compare cube.pfm cut.exr
else
  printf '\x76\x2f\x31\x01 more' >strange.exr
  expect exr_without_library 1 'strange.exr is an OpenEXR picture, which this build cannot read' compare half.pfm strange.exr
fi
head -c 100 half.pfm >cut.pfm
printf 'PF 70000 70000 1 more' >huge.pfm
printf 'Pf 1 1 1 \x7f\xc0\0\0' >nan.pfm
printf 'PF 1 1 1 \0\0\0\0\0\0\0\0\0\0\0\0' >black.pfm
printf 'PF 1 1 1 \x3f\0\0\0\x3f\0\0\0\x3f\0\0\0' >lit.pfm
expect truncated_pfm 1 'cut.pfm is truncated: write it again' compare half.pfm cut.pfm
expect huge_pfm 1 'huge.pfm is not a PFM of 1 to 16777216 pixels' compare huge.pfm half.pfm
expect nan_pfm 1 'nan.pfm has a value that is NaN, in column 0 of row 0' compare black.pfm nan.pfm
expect align_black 1 '--align finds no scale' compare lit.pfm black.pfm --align
expect align_levels 1 '--align changes linear light' compare a.ppm b.ppm --align
expect exposure_of_levels 1 '--exposure changes linear light' compare a.ppm b.ppm --exposure 1
expect exposure_twice 1 'drop --exposure' compare a.ppm half.pfm --align --exposure 1
expect strange_exposure 1 '--exposure is' compare half.pfm quarter.pfm --exposure bright
expect sizes_of_light 1 'lit.pfm has 1×1 pixels, half.pfm 4×3' compare lit.pfm half.pfm

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
expect one_picture 2 'needs B' compare a.ppm
expect map_ending 1 'must end in .png' compare a.ppm b.ppm -o map.jpg
expect map_nowhere 1 'no/such/map.png' compare none.png b.ppm -o no/such/map.png
expect map_is_a_folder 1 'is a folder' compare none.png b.ppm -o folder.png
ln a.ppm linked.png
expect map_over_an_input 1 'linked.png would overwrite the input a.ppm of A' compare a.ppm b.ppm -o linked.png
expect json_over_an_input 1 'b.ppm would overwrite the input b.ppm of B' compare a.ppm b.ppm --json b.ppm
expect one_file_of_two 1 'name the same file' compare a.ppm b.ppm -o same.png --json same.png
check nothing_refused_is_written test ! -e refused.png

finish
