#!/usr/bin/env bash
# Choices of a device that servers follow: animation and camera. Usage: cli_serve_choices_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

if [ $# -eq 0 ] && "${run[@]}" --help | grep -q '^ *serve '; then  # not under an emulated CPU
  # Two animations of one node, which do not play together; and 10,000 triangles without area, which take memory.
  head -c 360000 /dev/zero >zeros.bin
  cat >walk.gltf <<'END'
{"asset":{"version":"2.0"},"buffers":[{"byteLength":360000,"uri":"zeros.bin"},{"byteLength":92,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAABAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAQAAAAAA="}],
"bufferViews":[{"buffer":1,"byteLength":36},{"buffer":1,"byteOffset":36,"byteLength":8},{"buffer":1,"byteOffset":44,"byteLength":24},{"buffer":1,"byteOffset":68,"byteLength":24},{"buffer":0,"byteLength":360000}],
"accessors":[{"bufferView":0,"count":3,"type":"VEC3","componentType":5126},{"bufferView":1,"count":2,"type":"SCALAR","componentType":5126},{"bufferView":2,"count":2,"type":"VEC3","componentType":5126},{"bufferView":3,"count":2,"type":"VEC3","componentType":5126},{"bufferView":4,"count":30000,"type":"VEC3","componentType":5126}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},{"primitives":[{"attributes":{"POSITION":4}}]}],"nodes":[{"mesh":0},{"mesh":1}],"scenes":[{"nodes":[0,1]}],
"animations":[{"name":"aside","samplers":[{"input":1,"output":2}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]},
{"name":"up","samplers":[{"input":1,"output":3}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}]}
END
  mkdir scenes
  "${run[@]}" bake walk.gltf -o scenes/walk.pray >/dev/null 2>&1
  awk 'BEGIN { for (i = 0; i < 10000; ++i) printf "v %.2f %.2f %d.5\n", 431250.37 + i % 100, 5411875.62 + int(i / 100), i % 3
    for (i = 1; i < 9900; ++i) if (i % 100) print "f", i, i + 1, i + 100 }' >far.obj
  "${run[@]}" bake far.obj -o scenes/far.pray >/dev/null 2>&1
  "${run[@]}" serve --listen 127.0.0.1:0 --scenes scenes --threads 1 >serve.out 2>serve.err &
  server=$!
  wait_for $server grep -q '^listening' serve.out
  address=$(sed -n 's/^listening on \([0-9.:]*\): .*/\1/p' serve.out)
  small=(--size 32x24 --threads 1)

  # Goal: server and device show the animation asked for, whether the device has the scene, fetches it, or has no room
  # for it. Method: rows of a late frame, with a server and without; the animations differ there.
  for wanted in up 1 aside all none; do
    chosen=(--animation "$wanted")
    "${run[@]}" render walk.gltf "${small[@]}" "${chosen[@]}" --frames 6:9 -o alone.ppm >/dev/null 2>&1
    cp alone-0009.ppm "alone_$wanted.ppm"
    expect_in_use "animation_${wanted}_shared" 'render servers: the device rendered' \
      render scenes/walk.pray "${small[@]}" "${chosen[@]}" --frames 6:9 --server "$address" --share 0.5 -o shared.ppm
    expect "animation_${wanted}_fetched" 0 'per frame' \
      render walk "${small[@]}" "${chosen[@]}" --frames 6:9 --server "$address" -o fetched.ppm
    expect "animation_${wanted}_thin" 0 'rendered 0 %' \
      render walk "${small[@]}" "${chosen[@]}" --frames 6:9 --server "$address" --memory 400K -o thin.ppm
    for kind in shared fetched thin; do
      for n in 6 7 8 9; do check "animation_${wanted}_${kind}_$n" cmp -s alone-000$n.ppm $kind-000$n.ppm; done
    done
  done
  for other in aside none; do check "up_is_not_$other" test "$(cmp -s alone_up.ppm alone_$other.ppm; echo $?)" = 1; done
  expect animation_unknown 1 "'jump': it must be all, none, or a name or number of 0 'aside', 1 'up'" \
    render walk "${small[@]}" --server "$address" --animation jump -o b.ppm
  expect animation_unknown_to_the_server 1 'the scene lacks the animation' \
    render walk "${small[@]}" --server "$address" --memory 400K --animation jump -o b.ppm
  expect animation_viewed 0 '' view walk.gltf "${small[@]}" --server "$address" --animation none --screen null --frames 3

  # Goal: --camera counts in the model's own coordinates, also on a device that has no room for the model.
  from=(--size 32x24 --threads 1 --camera "431300,5411930,200 431300,5411930,0 0,1,0 30")
  expect far_camera 0 'ns per pixel' render far.obj "${from[@]}" -o far.ppm
  expect far_camera_thin 0 'rendered 0 %' render far "${from[@]}" --server "$address" --memory 400K -o far_thin.ppm
  check far_camera_sees_the_same cmp -s far.ppm far_thin.ppm
  check far_camera_sees_something test "$(tail -c 2304 far.ppm | od -An -v -tx1 -w3 | sort -u | wc -l)" -gt 2
  kill -INT $server
  wait $server
fi

finish
