@ Entry of the static ARM programs, before the C library's: a CPU that lacks what the program is built for gets one line, not
@ an illegal instruction. The kernel tells what the CPU has in the auxiliary vector, above the environment on the stack.
@ POCKETRAY_CPU_VERSION: of the architecture, as in ARMv7; POCKETRAY_CPU_BITS: of AT_HWCAP; POCKETRAY_CPU_NAME: what to tell.

#define AT_PLATFORM 15
#define AT_HWCAP 16
#define SYSCALL_EXIT 1
#define SYSCALL_WRITE 4

  .syntax unified
  .arch armv4t
  .arm
  .text
  .global pocketray_start
  .type pocketray_start, %function
pocketray_start:
  ldr r1, [sp]
  add r2, sp, #8
  add r2, r2, r1, lsl #2
1:                        @ skip the environment
  ldr r3, [r2], #4
  cmp r3, #0
  bne 1b
  mov r4, #0              @ AT_HWCAP
  mov r5, #0              @ AT_PLATFORM: "v5l", "v7l" …
2:
  ldr r3, [r2], #8
  cmp r3, #0
  beq 3f
  cmp r3, #AT_HWCAP
  ldreq r4, [r2, #-4]
  cmp r3, #AT_PLATFORM
  ldreq r5, [r2, #-4]
  b 2b
3:
  ldr r3, =POCKETRAY_CPU_BITS
  and r4, r4, r3
  cmp r4, r3
  bne wrong
  cmp r5, #0              @ unknown: the bits must do
  beq right
  ldrb r5, [r5, #1]
  cmp r5, #'0' + POCKETRAY_CPU_VERSION
  blt wrong
right:
  ldr r3, =_start
  bx r3
wrong:
  mov r0, #2
  ldr r1, =message
  mov r2, #(message_end - message)
  mov r7, #SYSCALL_WRITE
  svc #0
  mov r0, #1
  mov r7, #SYSCALL_EXIT
  svc #0
  .ltorg

  .section .rodata
message:
  .ascii "pocketray: this program is built for "
  .ascii POCKETRAY_CPU_NAME
  .ascii ", which this CPU is not: build it for this one, see make DEVICE=\n"
message_end:
  .section .note.GNU-stack, "", %progbits
