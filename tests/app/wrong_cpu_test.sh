#!/usr/bin/env bash
# wrong_cpu_test.sh PROGRAM ARCHITECTURE : a static program on a CPU without its instructions says so in one line and ends with
# status 1; on its own CPU it runs. Method: CPUs of qemu, one that has all it needs and one that lacks something.
set -u
program=$1 qemu=qemu-arm
case $2 in
  armv5te) right=arm926 wrong=ti925t ;;  # an ARMv4T
  armv6) right=arm1176 wrong=arm926 ;;
  armv7-a-*) right=cortex-a7 wrong=cortex-a9 ;;  # no division
  armv7-a) right=cortex-a9 wrong=arm1176 ;;
  mips) qemu=qemu-mipsel right=24Kf wrong=4Kc ;;  # MIPS32's first release
  *) echo "skipped: $2 has no smaller brothers"; exit 77 ;;
esac
failures=0
said=$($qemu -cpu $right "$program" --version 2>&1)
[ $? = 0 ] || { echo "FAILED on $right: $said"; failures=1; }
said=$($qemu -cpu $wrong "$program" --version 2>&1)
status=$?
[ $status = 1 ] && [ "$(wc -l <<<"$said")" = 1 ] && grep -q '^pocketray: this program is built for a' <<<"$said" ||
  { echo "FAILED on $wrong: status $status: $said"; failures=1; }
exit $failures
