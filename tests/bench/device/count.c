/* A plugin for QEMU's user mode: counts the instructions of each block of an ARM or MIPS program by class.
 * bench_device.py adds them up by symbol.
 *
 *   qemu-arm -plugin ./libcount.so,out=FILE PROGRAM ARGUMENTS…
 *
 * FILE: one line per block, "address executions" and how many instructions of each class it holds. Only programs with
 * one thread are counted rightly. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is used of qemu-plugin.h, version 1, which Debian does not package. */
typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef struct {
  const char* target_name;
} qemu_info_t;
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 };
typedef void (*translated_t)(qemu_plugin_id_t id, struct qemu_plugin_tb* block);
typedef void (*exit_t)(qemu_plugin_id_t id, void* data);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id, translated_t callback);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, exit_t callback, void* data);
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb* block, enum qemu_plugin_op op, void* counter,
                                              uint64_t step);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb* block);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb* block);
struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb* block, size_t index);
const void* qemu_plugin_insn_data(const struct qemu_plugin_insn* instruction);
size_t qemu_plugin_insn_size(const struct qemu_plugin_insn* instruction);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

/* In the order of bench_device.py. A load or store of n registers counts as n. */
enum { INTEGER, BRANCH, LOAD, STORE, MULTIPLY, DIVIDE, FLOAT, FLOAT_DIVIDE, VECTOR, CLASS_COUNT };

struct block {
  uint64_t executions, address;
  unsigned count[CLASS_COUNT];
  struct block* next;
};
static struct block* blocks;
static FILE* out;
static enum { ARM, ARM_64, MIPS } cpu;

static unsigned registers_in(uint32_t list) { return (unsigned)__builtin_popcount(list); }

/* ARM DDI 0406C, A5 and A7: coprocessors 10 and 11 and the vector space, the same in both instruction sets. */
static int class_of_float(uint32_t w, unsigned* n) {
  if ((w >> 24 & 15) < 14) { /* loads, stores, and moves of two registers */
    if ((w & 0x0fe00000) == 0x0c400000) return FLOAT;
    *n = w & 0x01000000 && !(w & 0x00200000) ? 1 : (w & 0xff) ? w & 0xff : 1;
    return w >> 20 & 1 ? LOAD : STORE;
  }
  if (!(w & 0x10) && ((w & 0x0fb00e50) == 0x0e800a00 || (w & 0x0fbf0ed0) == 0x0eb10ac0)) return FLOAT_DIVIDE;
  return FLOAT;
}

static int class_of_arm(uint32_t w, unsigned* n) {
  uint32_t group = w >> 25 & 7, coprocessor = w >> 8 & 14;
  *n = 1;
  if (w >> 28 == 15) {
    if (group == 1) return VECTOR;
    if ((w >> 24 & 15) == 4) return w >> 21 & 1 ? LOAD : STORE;
    return group == 5 ? BRANCH : INTEGER;
  }
  switch (group) {
    case 0:
      if ((w & 0x0fffffd0) == 0x012fff10) return BRANCH;
      if ((w & 0x90) == 0x90) {
        if ((w & 0x60) == 0) return w >> 24 & 1 ? LOAD : MULTIPLY;
        return w >> 20 & 1 || (w & 0x60) == 0x40 ? LOAD : STORE;
      }
      return (w & 0x01900090) == 0x01000080 ? MULTIPLY : INTEGER;
    case 1:
      return INTEGER;
    case 3:
      if (w & 0x10) {
        if ((w & 0x0fd0f0f0) == 0x0710f010) return DIVIDE;
        return (w & 0x0f800000) == 0x07000000 ? MULTIPLY : INTEGER;
      }
      return w >> 20 & 1 ? LOAD : STORE;
    case 2:
      return w >> 20 & 1 ? LOAD : STORE;
    case 4:
      *n = registers_in(w & 0xffff);
      return w >> 20 & 1 ? LOAD : STORE;
    case 5:
      return BRANCH;
    default:
      return coprocessor == 10 && !(w >> 24 & 1 && group == 7) ? class_of_float(w, n) : INTEGER;
  }
}

static int class_of_thumb16(uint32_t h, unsigned* n) {
  *n = 1;
  if ((h & 0xff00) == 0x4700) return BRANCH;
  if ((h & 0xffc0) == 0x4340) return MULTIPLY;
  if (h < 0x4800) return INTEGER;
  if (h < 0x5000) return LOAD;
  if (h < 0x6000) return (h & 0x0e00) >= 0x0600 ? LOAD : STORE;
  if (h < 0xa000) return h & 0x0800 ? LOAD : STORE;
  if (h < 0xb000) return INTEGER;
  if (h < 0xc000) {
    if ((h & 0xfe00) == 0xb400 || (h & 0xfe00) == 0xbc00) {
      *n = registers_in(h & 0x1ff);
      return h & 0x0800 ? LOAD : STORE;
    }
    return (h & 0xf500) == 0xb100 ? BRANCH : INTEGER;
  }
  if (h < 0xd000) {
    *n = registers_in(h & 0xff);
    return h & 0x0800 ? LOAD : STORE;
  }
  return BRANCH;
}

static int class_of_thumb32(uint32_t a, uint32_t b, unsigned* n) {
  *n = 1;
  if ((a & 0xef00) == 0xef00) return VECTOR;
  if ((a & 0xfc00) == 0xec00) return (b >> 8 & 14) == 10 ? class_of_float(a << 16 | b, n) : INTEGER;
  if ((a & 0xff10) == 0xf900) return a & 0x20 ? LOAD : STORE;
  if ((a & 0xfe40) == 0xe800) {
    *n = registers_in(b);
    return a & 0x10 ? LOAD : STORE;
  }
  if ((a & 0xfff0) == 0xe8d0 && (b & 0xffe0) == 0xf000) return BRANCH;
  if ((a & 0xfe40) == 0xe840) {
    *n = 2;
    return a & 0x10 ? LOAD : STORE;
  }
  if ((a & 0xf800) == 0xf000 && b & 0x8000) return BRANCH;
  if ((a & 0xfe00) == 0xf800) return a & 0x10 ? LOAD : STORE;
  if ((a & 0xff00) == 0xfb00) return (a & 0xffd0) == 0xfb90 ? DIVIDE : MULTIPLY;
  return INTEGER;
}

/* ARM DDI 0487, C4.1. */
static int class_of_a64(uint32_t w, unsigned* n) {
  *n = 1;
  if ((w & 0x1c000000) == 0x14000000) return BRANCH;
  if ((w & 0x0a000000) == 0x08000000) {
    uint32_t form = w >> 28 & 3; /* exclusive or structures, literal, pair, register */
    int last_bit = w >> 22 & 1, is_vector = w >> 26 & 1;
    int is_load = form == 1 ? 1 : form == 3 && !is_vector ? (w >> 22 & 3) != 0 : last_bit;
    if (form == 2) *n = 2;
    return is_load ? LOAD : STORE;
  }
  if ((w & 0x7fe0f000) == 0x1ac00000 && (w >> 11 & 1) == 1) return DIVIDE;
  if ((w & 0x1f000000) == 0x1b000000) return MULTIPLY;
  if ((w & 0x0e000000) == 0x0e000000) {
    if ((w & 0x5f20fc00) == 0x1e201800 || (w & 0x5f3ffc00) == 0x1e21c000 || (w & 0xbfa0fc00) == 0x2e20fc00)
      return FLOAT_DIVIDE;
    return (w & 0x50000000) == 0x10000000 ? FLOAT : VECTOR;
  }
  return INTEGER;
}

/* MIPS32 release 2 (MD00086, A.2), without MIPS16 and microMIPS. */
static int class_of_mips(uint32_t w, unsigned* n) {
  uint32_t opcode = w >> 26, format = w >> 21 & 31, function = w & 63;
  *n = 1;
  switch (opcode) {
    case 0x00:
      if (function == 0x08 || function == 0x09) return BRANCH;
      if (function == 0x18 || function == 0x19) return MULTIPLY;
      return function == 0x1a || function == 0x1b ? DIVIDE : INTEGER;
    case 0x01: /* traps are between branches */
      return (w >> 16 & 0x0f) < 8 ? BRANCH : INTEGER;
    case 0x11:
      if (format == 8) return BRANCH;
      return format >= 16 && (function == 0x03 || function == 0x04 || function == 0x15 || function == 0x16)
                 ? FLOAT_DIVIDE
                 : FLOAT;
    case 0x13:
      if (function == 0x0f) return INTEGER; /* prefetch */
      if (function < 0x08) *n = function == 0x01 ? 2 : 1;
      return function < 0x08 ? LOAD : function < 0x10 ? STORE : FLOAT;
    case 0x1c:
      return function < 0x06 ? MULTIPLY : INTEGER;
    case 0x35:
    case 0x3d:
      *n = 2;
      break;
    default:
      break;
  }
  if (opcode < 0x08 || (opcode >= 0x14 && opcode < 0x18)) return BRANCH;
  if (opcode < 0x20 || opcode == 0x2f || opcode == 0x33) return INTEGER; /* cache and prefetch */
  return opcode & 0x08 ? STORE : LOAD;
}

/* Thumb code is recognised by an instruction of two bytes or at an odd half word; a block of four-byte instructions by
 * their first halves. */
static int is_thumb(const struct qemu_plugin_tb* tb) {
  int all_look_like_it = 1;
  if (qemu_plugin_tb_vaddr(tb) & 2) return 1;
  for (size_t i = 0; i < qemu_plugin_tb_n_insns(tb); i++) {
    const struct qemu_plugin_insn* x = qemu_plugin_tb_get_insn(tb, i);
    uint16_t half;
    memcpy(&half, qemu_plugin_insn_data(x), 2);
    if (qemu_plugin_insn_size(x) == 2) return 1;
    if (half >> 11 < 0x1d) all_look_like_it = 0;
  }
  return all_look_like_it;
}

static void add_block(qemu_plugin_id_t id, struct qemu_plugin_tb* tb) {
  struct block* block = calloc(1, sizeof *block);
  int thumb = cpu == ARM && is_thumb(tb);
  (void)id;
  if (!block) abort();
  block->address = qemu_plugin_tb_vaddr(tb);
  for (size_t i = 0; i < qemu_plugin_tb_n_insns(tb); i++) {
    const struct qemu_plugin_insn* x = qemu_plugin_tb_get_insn(tb, i);
    unsigned n = 1;
    uint16_t half[2] = {0, 0};
    uint32_t word;
    int class;
    memcpy(half, qemu_plugin_insn_data(x), qemu_plugin_insn_size(x));
    memcpy(&word, half, 4);
    if (cpu == MIPS)
      class = class_of_mips(word, &n);
    else if (cpu == ARM_64)
      class = class_of_a64(word, &n);
    else if (!thumb)
      class = class_of_arm(word, &n);
    else
      class = qemu_plugin_insn_size(x) == 2 ? class_of_thumb16(half[0], &n) : class_of_thumb32(half[0], half[1], &n);
    block->count[class] += class == LOAD || class == STORE ? 1 + (n << 16) : 1; /* high half: registers moved */
  }
  block->next = blocks, blocks = block;
  qemu_plugin_register_vcpu_tb_exec_inline(tb, QEMU_PLUGIN_INLINE_ADD_U64, &block->executions, 1);
}

static void write_counts(qemu_plugin_id_t id, void* data) {
  (void)id, (void)data;
  for (const struct block* block = blocks; block; block = block->next) {
    if (!block->executions) continue;
    fprintf(out, "%" PRIx64 " %" PRIu64, block->address, block->executions);
    for (int i = 0; i < CLASS_COUNT; i++) fprintf(out, " %u", block->count[i] & 0xffff);
    fprintf(out, " %u %u\n", block->count[LOAD] >> 16, block->count[STORE] >> 16);
  }
  fclose(out);
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t* info, int argc,
                                                               char** argv) {
  for (int i = 0; i < argc; i++)
    if (!strncmp(argv[i], "out=", 4)) out = fopen(argv[i] + 4, "w");
  if (!out) {
    fprintf(stderr, "count: out=FILE is missing or cannot be written\n");
    return -1;
  }
  cpu = !strcmp(info->target_name, "aarch64") ? ARM_64 : !strncmp(info->target_name, "mips", 4) ? MIPS : ARM;
  qemu_plugin_register_vcpu_tb_trans_cb(id, add_block);
  qemu_plugin_register_atexit_cb(id, write_counts, NULL);
  return 0;
}
