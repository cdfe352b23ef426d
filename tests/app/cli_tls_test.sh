#!/usr/bin/env bash
# Keys and encrypted links. Usage: cli_tls_test.sh PROGRAM [EMULATOR...] Without openssl, a second implementation is missing,
# and the test says so.
. "$(dirname "$0")/cli.sh"
"${run[@]}" --help | grep -q '^ *keygen ' || finish  # a build without a network

# Goal: a key is made once, for its owner alone, and is what its help says. Method: with and without -o, twice, with an
# umask that takes and one that gives, where it cannot be written.
(umask 000 && exec "${run[@]}" keygen) >made.out 2>&1
check keygen_says_how_to_use_it grep -qF -- 'pocketray.key: copy it to the server and to the device' made.out
check keygen_says_it_in_one_line test "$(wc -l <made.out)" = 1
check keygen_is_private test "$(stat -c %a pocketray.key)" = 600
check keygen_has_256_bits grep -qxE 'pocketray-key-1:[0-9a-f]{64}' pocketray.key
cp -p pocketray.key before.key
expect keygen_never_overwrites 1 'pocketray.key: a file of that name exists' keygen
check keygen_leaves_what_is_there cmp -s pocketray.key before.key
expect keygen_to_a_file 0 '--key other.key' keygen -o other.key
check keys_differ test "$(cat other.key)" != "$(cat pocketray.key)"
expect keygen_to_standard_output 1 'a key needs a file' keygen -o -
expect keygen_without_a_folder 1 'no/such/folder/k: No such file' keygen -o no/such/folder/k
expect keygen_help 0 '64 hexadecimal digits' keygen --help

if "${run[@]}" scenes --server 127.0.0.1:1 --key pocketray.key 2>&1 | grep -q 'this build has no TLS'; then
  # Goal: a build without TLS refuses keys with one line wherever they can be given.
  for command in "serve --listen :0" "scenes --server :1" "render cube -o b.ppm --server :1" "view cube --screen null --server :1"; do
    # shellcheck disable=SC2086
    expect "no_tls_${command%% *}" 1 '^pocketray: --key: this build has no TLS: rebuild it' $command --key pocketray.key
  done
  finish
fi

# Goal: what is no key, or not private, is refused with one line that names the file, before anything else.
cp other.key open.key && chmod 640 open.key
head -c 60 other.key >cut.key && chmod 600 cut.key
expect key_that_others_read 1 '--key open.key: others may read the key: chmod 600 open.key' serve --listen :0 --key open.key
expect key_that_others_read_here 1 'chmod 600 open.key' render cube -o b.ppm --server :1 --key open.key
expect key_cut 1 '--key cut.key: not a key: make one with' serve --listen :0 --key cut.key
expect key_missing 1 '--key none.key: no such file: make one with' scenes --server :1 --key none.key
expect key_folder 1 '--key .: not a file' view cube --screen null --server :1 --key .
expect key_without_a_server 1 '--key encrypts links to render servers: add --server' render cube -o b.ppm --key other.key
expect key_and_no_key 2 'excludes' serve --key other.key --insecure-lan
expect key_help 0 '--key' render --help-all
expect serve_to_others_offers_a_key 1 'keygen.*--insecure-lan' serve --listen 0.0.0.0:0
[ $# -eq 0 ] || finish  # under an emulated CPU

serve() {  # NAME OPTIONS... : starts a server; sets `server`, `address` and `port`
  "${run[@]}" serve --threads 1 --memory 16M "${@:2}" >"$1.out" 2>"$1.err" &
  server=$!
  wait_for $server grep -q '^listening' "$1.out"
  port=$(sed -n 's/^listening on [0-9.]*:\([0-9]*\): .*/\1/p' "$1.out") address=127.0.0.1:$port
}
stop() {  # NAME : ends it
  kill -INT $server
  wait $server
  check "$1_ends" test $? -eq 3
}

serve secret --listen 0.0.0.0:0 --key pocketray.key
check serve_says_who_is_let_in grep -q 'only for holders of the key in pocketray.key, encrypted; [0-9.]* MiB' secret.out
with=(--server "$address" --key pocketray.key)
expect tls_scenes 0 '^ *cornell +45 109 triangles' scenes "${with[@]}"
shared=(--size 64x48 --threads 1 --frames 0:7)
"${run[@]}" render seesaw "${shared[@]}" -o alone.ppm >/dev/null

# Goal: whoever has another key, or none, is told so in one line on both sides, and renders alone.
expect tls_other_key 1 "$address: its key differs: copy the same key file to both sides" scenes --server "$address" --key other.key
expect tls_no_key 1 "$address: it requires a key: use the server's key \(--key\)" scenes --server "$address"
expect tls_render_with_another_key 0 'its key differs.*continuing without it' \
  render seesaw "${shared[@]}" --server "$address" --key other.key -o refused.ppm
check tls_refused_gives_the_same_picture cmp -s alone-0007.ppm refused-0007.ppm
check serve_tells_of_another_key grep -q 'disconnected: its key differs' secret.out
check serve_tells_of_no_key grep -q 'disconnected: it does not use TLS' secret.out

# Goal: with a key a server may listen to others, and pictures are the same as without one, whoever renders. Method: a
# sequence shared, one by a device without the scene, in a window, fetched; sealed, like everything here.
expect_in_use tls_shared ', sent [1-9]' render seesaw "${shared[@]}" --emulate pi-zero --coherence off "${with[@]}" -o shared.ppm
expect tls_memory_is_in_the_map 0 'frame +encrypted links +[0-9.]+ KiB' render seesaw "${shared[@]}" "${with[@]}" --plan -o plan.ppm
expect tls_thin 0 'rendered 0 %' render seesaw "${shared[@]}" "${with[@]}" --memory 500K -o thin.ppm
for n in 0 1 2 3 4 5 6 7; do
  check "tls_shared_$n" cmp -s alone-000$n.ppm shared-000$n.ppm
  check "tls_thin_$n" cmp -s alone-000$n.ppm thin-000$n.ppm
done
expect tls_view 0 '' view seesaw "${small[@]}" --screen null --frames 5 "${with[@]}"
expect_in_use tls_verify 'of their pixels per frame checked, which catches one wrong row' \
  render seesaw "${shared[@]}" --emulate pi-zero --coherence off "${with[@]}" --verify 9 -o verified.ppm
check tls_verified_gives_the_same_picture cmp -s alone-0007.ppm verified-0007.ppm

if command -v openssl >/dev/null && openssl ciphers -psk 2>/dev/null | grep -q ECDHE-PSK-CHACHA20-POLY1305; then
  # Goal: another implementation of TLS with the key is connected with the one cipher, and no other; a wrong key, another
  # version or cipher, a cut or replayed handshake is not. Method: openssl; what the server sends first is its hello.
  key=$(sed 's/.*://' pocketray.key) wrong=$(sed 's/.*://' other.key)
  connect() {  # KEY OPTIONS... : what the server sends, and what openssl says of the connection
    timeout 20 openssl s_client -connect "$address" -psk_identity pocketray -psk "$@" -ign_eof 2>&1 <"$input"
  }
  # A hello, after which the server answers nothing; it is ended as the first bytes are no message.
  input=hello && printf 'not a hello, but thirty-two bytes' >hello
  connect "$key" -tls1_2 >right.txt
  check openssl_is_connected grep -qa 'PRAY' right.txt
  check openssl_uses_the_cipher grep -qaE 'Cipher( is|  *:).*ECDHE-PSK-CHACHA20-POLY1305' right.txt
  check openssl_uses_the_curve grep -qa 'X25519' right.txt
  refused() { ! grep -qa PRAY "$1" && grep -qaiE "$2" "$1"; }
  connect "$wrong" -tls1_2 >wrong.txt
  check openssl_wrong_key refused wrong.txt 'bad record mac|decrypt error'
  connect "$key" -tls1_2 -psk_identity somebody >identity.txt
  check openssl_wrong_identity refused identity.txt 'unknown psk identity|alert'
  for cipher in PSK-CHACHA20-POLY1305 PSK-AES128-GCM-SHA256 ECDHE-PSK-AES128-CBC-SHA256 DHE-PSK-CHACHA20-POLY1305; do
    connect "$key" -tls1_2 -cipher "$cipher" >cipher.txt
    check "openssl_$cipher" refused cipher.txt 'handshake failure'
  done
  connect "$key" -tls1_3 >version.txt
  check openssl_other_version refused version.txt 'protocol version|alert'
  connect "$key" -tls1_2 -groups P-256 >curve.txt
  check openssl_other_curve refused curve.txt 'unexpected eof|alert'
  # What openssl sent, replayed whole and cut.
  openssl s_client -connect "$address" -psk_identity pocketray -psk "$key" -tls1_2 -msg <hello 2>/dev/null |
    awk '/^>>>/ { out = 1; next } /^<<</ { out = 0 } out && /^ +[0-9a-f][0-9a-f] / { print }' | tr -d ' \n' >sent.hex
  check openssl_shows_what_it_sends test "$(wc -c <sent.hex)" -gt 300
  for bytes in 1 5 60 $(($(wc -c <sent.hex) / 2)); do
    exec {file}<>"/dev/tcp/127.0.0.1/$port"
    printf "$(head -c $((2 * bytes)) sent.hex | sed 's/../\\x&/g')" >&$file
    timeout 10 head -c 4096 <&$file >answer.txt 2>/dev/null
    exec {file}>&-
    check "replayed_$bytes" test "$(grep -ca PRAY answer.txt)" = 0
  done
  expect tls_goes_on 0 '^ *cornell ' scenes "${with[@]}"

  # Goal: a device tells of an openssl server with another key, and hangs at none that says nothing.
  openssl s_server -accept 127.0.0.1:0 -nocert -tls1_2 -psk "$wrong" -psk_identity pocketray >other.out 2>&1 < <(sleep 60) &
  other=$!
  for _ in $(seq 100); do grep -q '^ACCEPT ' other.out && break; sleep 0.1; done
  expect tls_openssl_server 1 'its key differs' scenes --server "$(sed -n 's/^ACCEPT //p' other.out)" --key pocketray.key
  kill $other 2>/dev/null
  wait $other 2>/dev/null
else
  echo "no openssl with ECDHE-PSK-CHACHA20-POLY1305: skipping what needs another implementation of TLS"
fi

# Goal: a server that is killed costs no picture; without its key it does not know the device. Method: as cli_serve does.
"${run[@]}" render seesaw --size 96x72 --frames 0:24 --emulate tablet -o lost.ppm "${with[@]}" >lost.out 2>lost.err &
device=$!
wait_for $device test -s lost-0004.ppm
kill -KILL $server
wait $server 2>/dev/null
wait $device
check tls_device_goes_on test $? -eq 0
check tls_loss_is_told_once test "$(grep -c "$address.* continuing without it" lost.err)" = 1
"${run[@]}" render seesaw --size 96x72 --frames 0:24 -o kept.ppm >/dev/null
for n in 00 04 05 12 24; do check "tls_frame_${n}_is_complete" cmp -s kept-00$n.ppm lost-00$n.ppm; done

serve plain --listen 127.0.0.1:0
expect tls_key_for_a_plain_server 1 "$address: it does not use TLS: give it the key, too, or use none here" \
  scenes --server "$address" --key pocketray.key
expect plain_goes_on 0 '^ *cornell ' scenes --server "$address"
stop plain

finish
