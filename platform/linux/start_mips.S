# Entry of the static MIPS program, before the C library's: a CPU of MIPS32's first release gets one line, not an illegal
# instruction. The kernel does not tell the release, so an instruction of the second one is tried.
# POCKETRAY_CPU_NAME: what to tell.

#define SIGILL 4
#define SYSCALL_EXIT 4001
#define SYSCALL_WRITE 4004
#define SYSCALL_RT_SIGACTION 4194
#define SIGNAL_SET_BYTES 16

  .set noreorder
  .set mips32r2
  .option pic0
  .text
  .global pocketray_start
  .type pocketray_start, @function
pocketray_start:
  move $16, $2            # what the kernel leaves to the C library
  li $4, SIGILL
  la $5, wrong_cpu
  li $6, 0
  li $7, SIGNAL_SET_BYTES
  li $2, SYSCALL_RT_SIGACTION
  syscall
  seb $8, $8              # of the second release
  li $4, SIGILL
  la $5, as_before
  li $6, 0
  li $7, SIGNAL_SET_BYTES
  li $2, SYSCALL_RT_SIGACTION
  syscall
  move $2, $16
  la $25, __start
  jr $25
  nop
wrong:
  li $4, 2
  la $5, message
  li $6, (message_end - message)
  li $2, SYSCALL_WRITE
  syscall
  li $4, 1
  li $2, SYSCALL_EXIT
  syscall

  .section .rodata
  .align 2
wrong_cpu:                # flags, handler, signals blocked meanwhile
  .word 0, wrong, 0, 0, 0, 0
as_before:
  .word 0, 0, 0, 0, 0, 0
message:
  .ascii "pocketray: this program is built for "
  .ascii POCKETRAY_CPU_NAME
  .ascii ", which this CPU is not: build it for this one, see make DEVICE=\n"
message_end:
  .section .note.GNU-stack, "", %progbits
