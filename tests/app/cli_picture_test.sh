#!/usr/bin/env bash
# Picture files; pictures do not depend on threads, accelerators or effects. Usage: cli_picture_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: every output exists and has its size. Method: PPM and PFM headers and byte counts, raw framebuffers.
expect render_ppm 0 'ns per pixel' render "$subject" "${small[@]}" -o a.ppm
check ppm_size test "$(stat -c %s a.ppm)" -eq $((13 + 32 * 24 * 3))
expect render_pfm 0 'ns per pixel' render "$subject" "${small[@]}" -o a.pfm
check pfm_size test "$(tail -c $((32 * 24 * 12)) a.pfm | wc -c)" -eq $((32 * 24 * 12))
expect render_raw 0 'ns per pixel' render "$subject" "${small[@]}" --raw-format rgb565 --rotate 90 --dither -o a.raw
check raw_size test "$(stat -c %s a.raw)" -eq $((32 * 24 * 2))
for aov in depth normal triangle cost; do expect "aov_$aov" 0 'ns per pixel' render "$subject" "${small[@]}" --aov $aov -o "$aov.pfm"; done
expect aov_is_told 0 'cost: dark violet is 0, yellow [0-9]+ boxes' render "$subject" --size 160x48 --threads 2 --aov cost -o legend.ppm
expect aov_without_legend 0 'ns per pixel' render "$subject" --size 160x48 --threads 2 --aov cost --no-legend -o plain.ppm
check legend_is_below_the_picture cmp -s <(head -c $((14 + 160 * 37 * 3)) legend.ppm) <(head -c $((14 + 160 * 37 * 3)) plain.ppm)
check legend_is_there bash -c '! cmp -s legend.ppm plain.ppm'
expect aov_raw_legend 0 '' render "$subject" --size 160x48 --threads 2 --aov cost --rotate 90 -o legend.raw
expect sequence 0 'per frame' render seesaw "${small[@]}" --frames 3:5 -o s.ppm
for n in 3 4 5; do check "sequence_file_$n" test -s s-000$n.ppm; done
check no_part_file_is_left test -z "$(ls ./*.part 2>/dev/null)"
expect still_sequence 0 'all frames are equal: the scene does not move' render cube "${small[@]}" --frames 0:1 -o s.ppm
expect still_time 0 'time has no effect: the scene does not move' render cube "${small[@]}" --time 2 -o s.ppm
expect time_beyond_the_animation 0 'the animation loops after [0-9.]+ s: --time 12 s shows' render seesaw "${small[@]}" --time 12 -o s.ppm
expect samples_of_aov 0 'samples has no effect on --aov depth' render cube "${small[@]}" --samples 4 --aov depth -o s.ppm
expect interleaved_is_no_resolution 1 'full, checkerboard or half' render cube "${small[@]}" --resolution interleaved -o s.ppm
expect compensation_of_nothing 0 'compensation has no effect: instant-radiosity is off .ambient instead.; --indirect instant-radiosity' \
  render seesaw "${small[@]}" --compensation rays -o s.ppm
expect ended_rays_in_words 0 'an error that may reach white; a greater --depth lowers it' \
  render cornell "${small[@]}" --depth 0 -o s.ppm
check no_note_without_need bash -c '! "$@" 2>&1 | grep -q pocketray:' _ "${run[@]}" render seesaw "${small[@]}" --frames 3:4 -o s.ppm
expect ended_rays_are_told 0 'ended at depth 0; the surroundings stand in.*: up to [0-9.]+ % of a sample, an error of at most [0-9.]+ of white' render cornell "${small[@]}" --depth 0 --exposure=-12 -o s.ppm
check no_ended_rays_are_told bash -c '! "$@" | grep -q "ended at depth"' _ "${run[@]}" render cornell "${small[@]}" --depth 8 -o s.ppm
expect render_png 0 'ns per pixel' render "$subject" "${small[@]}" -o a.png
check png_magic test "$(head -c 8 a.png | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a

# Goal: the picture depends only on what it should.
"${run[@]}" render "$subject" --size 32x24 --threads 1 -o one.ppm >/dev/null
"${run[@]}" render "$subject" --size 32x24 --threads 5 -o five.ppm >/dev/null
check threads_give_one_picture cmp -s one.ppm five.ppm
limit=(--radiosity --patches 300)  # what opening cornell solves; baking it solves more
[ "$subject" = cornell ] && "${run[@]}" help bake radiosity >/dev/null 2>&1 || limit=()
expect bake 0 'triangles' bake "$subject" "${limit[@]}" -o c.pray
expect render_baked 0 'ns per pixel' render c.pray --size 32x24 -o baked.ppm
check baked_gives_the_same_picture cmp -s one.ppm baked.ppm
"${run[@]}" render "$subject" --size 32x24 --effects all -o all.ppm >/dev/null
check all_effects_give_the_same_picture cmp -s one.ppm all.ppm
for accel in compact grid brute; do
  "${run[@]}" render "$subject" --size 32x24 --accel $accel -o $accel.ppm >/dev/null
  check "accel_${accel}_gives_the_same_picture" cmp -s one.ppm $accel.ppm
done
expect accel_name 1 'brute' render "$subject" --accel octree -o b.ppm
expect bake_compact 0 'triangles' bake "$subject" "${limit[@]}" --accel compact -o d.pray
check compact_is_smaller test "$(stat -c %s d.pray)" -lt "$(stat -c %s c.pray)"
expect render_baked_compact 0 'ns per pixel' render d.pray --size 32x24 -o baked_compact.ppm
check baked_compact_gives_the_same_picture cmp -s one.ppm baked_compact.ppm
expect plan_baked_compact 0 'accelerator compact' plan d.pray
expect plan_other_than_baked 0 'accelerator bvh' plan d.pray --accel bvh

# Goal: an emulated handheld is slower, has its own screen and cores, and the same picture.
expect emulate 0 '32×24.*1 thread, emulating tablet: 4.47 times slower' render "$subject" --size 32x24 \
  --emulate tablet -o emulated.ppm
check emulated_gives_the_same_picture cmp -s one.ppm emulated.ppm
[ $# -gt 0 ] || expect emulate_screen_and_cores 0 '640×480.*2 threads, emulating miyoo-mini' \
  render cube --emulate miyoo-mini -o large.ppm
expect emulate_in_bench 0 '"emulated": "tablet"' bench cube "${small[@]}" --frames 1 --emulate tablet --json -
expect emulate_in_view 0 '' view cube --size 32x24 --screen null --frames 2 --emulate tablet

finish
