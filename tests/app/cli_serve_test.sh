#!/usr/bin/env bash
# A render server and its devices. Usage: cli_serve_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: the render server reports its address, its scenes and why it cannot start, and ends on an interrupt.
# Method: any free port; an address that other machines reach; a port in use; an interrupt.
if "${run[@]}" --help | grep -q '^ *serve '; then
  expect serve_help 0 'insecure-lan' serve --help
  expect serve_to_others 1 'there is no authentication.*--insecure-lan' serve --listen 0.0.0.0:0
  expect serve_without_port 1 'HOST:PORT' serve --listen 127.0.0.1:
  expect serve_without_folder 1 'no/such/folder' serve --listen :0 --scenes no/such/folder
  expect serve_memory 1 'memory' serve --listen :0 --memory 1M
  expect serve_scene_memory 1 '--scene-memory is' serve --listen :0 --scene-memory much
  expect serve_clients 1 'clients' serve --clients 0
  expect serve_threads 1 '--threads is 4000000000: it must lie in 0 … 64' serve --listen :0 --threads 4000000000
fi
if [ $# -eq 0 ] && "${run[@]}" --help | grep -q '^ *serve '; then  # not under an emulated CPU
  "${run[@]}" render cornell --size 32x24 --threads 1 -o one.ppm >/dev/null
  limit=(--radiosity --patches 300)  # what opening cornell solves
  "${run[@]}" help bake radiosity >/dev/null 2>&1 || limit=()
  "${run[@]}" bake cornell "${limit[@]}" -o c.pray >/dev/null
  "${run[@]}" bake cornell "${limit[@]}" --accel compact -o d.pray >/dev/null
  mkdir scenes && cp d.pray scenes/ && head -c 5000 c.pray >scenes/cut.pray
  "${run[@]}" serve --listen 127.0.0.1:0 --scenes scenes --threads 2 >serve.out 2>serve.err &
  server=$!
  wait_for $server grep -q '^listening' serve.out
  check serve_lists_its_scenes grep -q '^ *d.pray ' serve.out
  check serve_leaves_out_what_is_broken test "$(grep -c '^pocketray: cut.pray is skipped: ' serve.err)" = 1
  address=$(sed -n 's/^listening on \([0-9.:]*\): .*/\1/p' serve.out)
  check serve_says_where_it_listens grep -qE '^127\.0\.0\.1:[0-9]+$' <<<"$address"

  # Goal: a device without the scene fetches it, and one without room for it shows the server's rendering: the same
  # pixels.
  expect scenes 0 '^ *d\.pray +45 109 triangles' scenes --server "$address"
  expect scenes_json 0 '"triangles": 45109' scenes --server "$address" --json -
  expect scenes_of_nobody 1 '127.0.0.1:1: nothing is listening' scenes --server 127.0.0.1:1
  expect scenes_without_server 2 'server' scenes
  remote=(--size 32x24 --server "$address")
  expect fetch 0 'device rendered [1-9]' render d "${remote[@]}" -o fetched.ppm
  check fetched_scene_gives_the_same_picture cmp -s one.ppm fetched.ppm
  "${run[@]}" render cornell --size 32x24 --fov 25 -o narrow.ppm >/dev/null
  expect field_of_view_of_servers 0 'ns per pixel' render d "${remote[@]}" --fov 25 -o narrow_shared.ppm
  check field_of_view_is_the_same_there cmp -s narrow.ppm narrow_shared.ppm
  expect fetch_from_the_one_that_has_it 0 'ns per pixel' render d --server 127.0.0.1:1 "${remote[@]}" -o second.ppm
  check second_server_gives_the_same_picture cmp -s one.ppm second.ppm
  expect fetch_unknown 1 'no_such is neither a file.* 127.*: it has cornell, ' render no_such "${remote[@]}" -o b.ppm
  expect fetch_from_nobody 1 'nothing is listening' render no_such --server 127.0.0.1:1 -o b.ppm
  for scene in cornell d d.pray; do
    expect "thin_$scene" 0 'device rendered 0 %' \
      render $scene "${remote[@]}" --memory 700K -o "thin_$scene.ppm"
    check "thin_${scene}_gives_the_same_picture" cmp -s one.ppm "thin_$scene.ppm"
  done
  expect thin_plan 0 'frame +output' render cornell "${remote[@]}" --memory 700K --plan -o b_thin.ppm
  expect thin_says_so 0 'does not fit in --memory 0.7M: the servers render every pixel.*M would hold' \
    render cornell "${remote[@]}" --memory 700K -o b_thin.ppm
  turned=(--rotate 90 --dither --exposure 0.5 --camera "0,0,3 0,0,0 0,1,0 40")
  expect raw_alone 0 '' render cornell --size 32x24 "${turned[@]}" -o alone.raw
  expect thin_raw 0 'rendered 0 %' render cornell "${remote[@]}" "${turned[@]}" --memory 700K -o thin.raw
  check thin_raw_is_the_same cmp -s alone.raw thin.raw
  expect raw_shared 0 '' render cornell "${remote[@]}" "${turned[@]}" -o shared.raw
  check shared_raw_is_the_same cmp -s alone.raw shared.raw
  expect seesaw_alone 0 '' render seesaw --size 32x24 --frames 3:5 -o alone.ppm
  expect thin_sequence 0 'rendered 0 %' render seesaw "${remote[@]}" --memory 400K --frames 3:5 -o thin.ppm
  for n in 3 4 5; do check "thin_frame_$n" cmp -s alone-000$n.ppm thin-000$n.ppm; done
  expect thin_view 0 '' view seesaw "${remote[@]}" --memory 500K --screen null --frames 3
  expect thin_without_server 1 'no server can render it; 127.*nothing is listening' \
    render cornell --server 127.0.0.1:1 --memory 700K -o b.ppm
  expect thin_camera_index 1 'cannot render with these settings' \
    render cornell "${remote[@]}" --memory 700K --camera-index 7 -o b.ppm
  expect thin_without_room 1 'MiB of memory without a scene' render cornell "${remote[@]}" --memory 64K -o b.ppm
  check no_picture_of_what_failed test ! -e b.ppm
  expect serve_port_is_taken 1 'another program is listening' serve --listen "$address"
  kill -INT $server
  wait $server
  check serve_is_interrupted test $? -eq 3
  check serve_prints_totals grep -q '^[1-9][0-9]* clients, [1-9][0-9]* frames' serve.out

  "${run[@]}" serve --listen 127.0.0.1:0 --threads 1 >sharing.out 2>sharing.err &
  server=$!
  wait_for $server grep -q '^listening' sharing.out
  address=$(sed -n 's/^listening on \([0-9.:]*\): .*/\1/p' sharing.out)

  # Goal: pictures with and without a server are equal, byte for byte, in every format and split. Method: sequences, so
  # that the server comes into use; sealed, like everything here.
  shared=(--size 64x48 --threads 1 --frames 0:7)
  for kind in plain raw share cost; do
    ending=ppm more=() sharing=(--server "$address")
    case $kind in
      raw) ending=raw more=(--raw-format rgb565 --dither --rotate 90) ;;
      share) sharing+=(--share 0.3) ;;
      cost) sharing+=(--price 2 --energy-pixel 1e-6 --energy-byte 1e-6 --cost-weight 3) ;;
    esac
    expect "render_alone_$kind" 0 'per frame' render seesaw "${shared[@]}" "${more[@]}" -o "alone.$ending"
    expect_in_use "render_shared_$kind" 'render servers: the device rendered' \
      render seesaw "${shared[@]}" "${more[@]}" "${sharing[@]}" -o "shared.$ending"
    for n in 0 1 2 3 4 5 6 7; do check "shared_${kind}_$n" cmp -s alone-000$n.$ending shared-000$n.$ending; done
  done
  # Goal: a flight around the scene looks the same whoever renders it, even on a device without the scene.
  flight=(--size 32x24 --threads 1 --frames 0:3 --orbit 7)
  expect orbit_alone 0 'per frame' render seesaw "${flight[@]}" -o alone.ppm
  expect orbit_shared 0 'render servers: the device rendered' render seesaw "${flight[@]}" --server "$address" -o shared.ppm
  expect orbit_thin 0 'per frame' render seesaw "${flight[@]}" --memory 700K --server "$address" -o thin.ppm
  for n in 0 1 2 3; do
    check "orbit_shared_$n" cmp -s alone-000$n.ppm shared-000$n.ppm
    check "orbit_thin_$n" cmp -s alone-000$n.ppm thin-000$n.ppm
  done
  # Goal: work before a frame is slowed down once on an emulated device, not twice.
  timeout -k 1 120 "${run[@]}" render seesaw --size 16x12 --frames 0:1 --emulate pi-zero --server "$address" \
    -o paced.ppm >/dev/null
  check emulated_frames_come test $? -eq 0
  expect_in_use render_two_servers ', sent [0-9]+' render seesaw "${shared[@]}" --coherence off --server "$address" --server "$address" -o two.ppm
  check two_servers_give_the_same_picture cmp -s alone-0007.ppm two-0007.ppm
  expect cost_cap 0 'per frame' render seesaw "${shared[@]}" --server "$address" --price 1 --cost-cap 0.001 -o cap.ppm
  check cost_cap_gives_the_same_picture cmp -s alone-0007.ppm cap-0007.ppm
  expect view_shared 0 '' view seesaw "${small[@]}" --screen null --frames 5 --server "$address"
  one=(render cube "${small[@]}" -o refused.ppm)
  expect server_without_port 1 'HOST:PORT' "${one[@]}" --server 127.0.0.1
  expect server_with_a_wrong_port 1 '99999.*HOST:PORT' "${one[@]}" --server 127.0.0.1:99999
  expect server_with_colons 1 'IPv6' "${one[@]}" --server "$address:1"
  expect server_radiance 1 'radiance' render cube "${small[@]}" -o refused.pfm --server "$address"
  expect server_aov 1 'colours' "${one[@]}" --aov depth --server "$address"
  expect servers_too_many 1 'at most 8' "${one[@]}" $(printf -- "--server $address %.0s" 1 2 3 4 5 6 7 8 9)
  for value in -2 1025; do expect "verify_$value" 1 '0 … 1024' "${one[@]}" --server "$address" --verify=$value; done
  expect verify_without_a_server 1 '--server' "${one[@]}" --verify=3
  expect near_lossless_without_a_server 1 '--server' "${one[@]}" --near-lossless
  # Goal: near-lossless pictures look the same. Method: an emulated radio, over which rows are coded.
  expect_in_use near_lossless_is_used 'render servers: the device rendered' render seesaw "${shared[@]}" --emulate pi-zero \
    --coherence off --server "$address" --near-lossless -o near.ppm
  expect near_lossless_looks_the_same 0 '' compare alone-0007.ppm near-0007.ppm --fail-above 0.02
  expect_in_use verify_prints_its_odds 'of their pixels per frame checked, which catches one wrong row per frame with a probability of' \
    render seesaw "${shared[@]}" --emulate pi-zero --coherence off --server "$address" --verify 9 -o verified.ppm
  for value in 1.5 -0.5; do expect "share_$value" 1 '0 … 1' "${one[@]}" --server "$address" --share=$value; done
  expect share_nan 1 'finite number' "${one[@]}" --server "$address" --share=nan
  for option in price energy-pixel energy-byte cost-weight cost-cap; do
    expect "${option}_below_0" 1 'it must lie in 0 …' "${one[@]}" --server "$address" --$option=-1
    expect "${option}_without_a_server" 1 '--server' "${one[@]}" --$option=1
  done
  expect price_is_no_number 1 'price' "${one[@]}" --server "$address" --price cheap
  expect cost_weight_and_cap 1 'exclude' "${one[@]}" --server "$address" --cost-weight 1 --cost-cap 1
  expect share_without_a_server 1 '--server' "${one[@]}" --share 0.5
  check nothing_refused_is_written test ! -e refused.ppm -a ! -e refused.pfm

  # Goal: killing a server during a sequence is reported in one line, and every picture is complete. Method: kill it
  # after a few frames of a slow emulated device.
  many=(render seesaw --size 96x72 --frames 0:24 --emulate tablet)
  "${run[@]}" "${many[@]}" -o lost.ppm --server "$address" >lost.out 2>lost.err &
  device=$!
  wait_for $device test -s lost-0004.ppm
  kill -KILL $server
  wait $server 2>/dev/null
  wait $device
  check device_goes_on_without_its_server test $? -eq 0
  check device_tells_the_loss_in_one_line test "$(grep -c "$address.* continuing without it" lost.err)" = 1
  check device_tells_nothing_else test "$(grep -vc "$news" lost.err)" = 1
  "${run[@]}" render seesaw --size 96x72 --frames 0:24 -o kept.ppm >/dev/null
  for n in 00 04 05 12 24; do check "frame_${n}_is_complete" cmp -s kept-00$n.ppm lost-00$n.ppm; done
  expect render_without_its_server 0 'continuing without it' render seesaw "${shared[@]}" --server "$address" -o gone.ppm
  check without_its_server_the_same_picture cmp -s alone-0007.ppm gone-0007.ppm
  expect view_without_its_server 0 'continuing without it' \
    view seesaw "${small[@]}" --screen null --frames 5 --server "$address"

  if "${run[@]}" --help | grep -q '^ *split-report '; then
    # Goal: the split report as text, JSON and file; invalid options are refused; an interrupt keeps finished results.
    report=(split-report cube --size 64x48 --steps 3 --frames 2 --device-ns 5000 --server-ns 500)
    expect split_report 0 '^ *chosen +0\.[0-9]+ ' "${report[@]}"
    expect split_report_paper 0 'Cornell box +2 ' "${report[@]}"
    expect split_report_file 0 '2 servers' "${report[@]}" --servers 2 --no-paper -o .
    check split_report_csv test "$(wc -l <split.csv)" -ge 5
    if command -v python3 >/dev/null; then
      "${run[@]}" "${report[@]}" --json - >figures.json 2>/dev/null
      check split_report_json_keys python3 -c '
import json
f = json.load(open("figures.json"))
assert all(set(f[k]) == {"m", "ns_per_pixel"} for k in ("chosen", "best"))
assert len(f["sweep"]) >= 3 and all(set(p) == {"m", "ns_per_pixel"} for p in f["sweep"])
assert f["best"]["ns_per_pixel"] == min(p["ns_per_pixel"] for p in f["sweep"]) < f["local_ns_per_pixel"]
keys = {"times_of", "processors", "share", "ns_per_pixel", "our_share", "our_ns_per_pixel"}
assert len(f["paper"]) == 6 and all(keys <= set(row) for row in f["paper"])
assert all(f[k] for k in ("energy_front", "price_front"))
assert [row["clients"] for row in f["one_server_many_clients"]] == [1, 2, 3, 4, 6, 8, 12, 16]'
    fi
    expect split_report_device 1 'gp2x' split-report cube --emulate toaster
    expect split_report_fast_device 1 'did not come into use .* larger --size' split-report cube --size 64x48 --device-ns 20
    expect split_report_no_server 1 'servers' "${report[@]}" --servers 0
    expect split_report_many_servers 1 'servers' "${report[@]}" --servers 9
    "${run[@]}" split-report cube --device-ns 5000 --server-ns 500 --frames 100 >/dev/null 2>interrupted.err &
    reporting=$!
    # The process is no longer the shell, and SIGINT, signal 2, is caught: the program is running.
    is_running() { grep -q split-report /proc/$reporting/cmdline && grep -qE '^SigCgt:.*[2367abef]$' /proc/$reporting/status; }
    wait_for $reporting is_running
    sleep 0.2
    kill -INT $reporting
    wait $reporting
    check split_report_is_interrupted test $? -eq 3
  fi
fi

finish
