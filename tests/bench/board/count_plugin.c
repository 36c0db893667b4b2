// SPDX-License-Identifier: MIT
// For QEMU's user emulation of 64-bit Arm: which blocks of instructions a program of one thread executes, how
// often, and the bytes that it loads and stores.  Written into the file of the argument out=FILE at the end.
//   qemu-aarch64 -plugin libframe_counts.so,out=counts.json PROGRAM ...
//
// Debian has no header of QEMU's plugin interface: what is used of its version 1 is declared here (QEMU 4.2
// and later; documentation "QEMU TCG Plugins").
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t PluginId;
typedef uint32_t MemoryInfo;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum { NO_REGISTERS = 0 };
enum { READS_AND_WRITES = 3 };

void qemu_plugin_register_vcpu_tb_trans_cb(PluginId id, void (*hear)(PluginId, struct qemu_plugin_tb*));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb* block, void (*hear)(unsigned, void*),
                                          int flags, void* data);
void qemu_plugin_register_vcpu_mem_cb(struct qemu_plugin_insn* instruction,
                                      void (*hear)(unsigned, MemoryInfo, uint64_t, void*), int flags,
                                      int which, void* data);
void qemu_plugin_register_atexit_cb(PluginId id, void (*hear)(PluginId, void*), void* data);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb* block);
struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb* block, size_t index);
const void* qemu_plugin_insn_data(const struct qemu_plugin_insn* instruction);
unsigned qemu_plugin_mem_size_shift(MemoryInfo info);
bool qemu_plugin_mem_is_store(MemoryInfo info);

// Straight code up to a branch.
struct Block {
  struct Block* next;
  uint64_t executed;
  size_t count;
  uint32_t codes[];
};

static struct Block* blocks;
static uint64_t loaded_bytes, stored_bytes;
static char out[4096];

static void block_runs(unsigned cpu, void* data) {
  struct Block* block = data;
  (void)cpu;
  ++block->executed;
}

static void memory_is_used(unsigned cpu, MemoryInfo info, uint64_t address, void* data) {
  const uint64_t bytes = UINT64_C(1) << qemu_plugin_mem_size_shift(info);
  (void)cpu, (void)address, (void)data;
  if (qemu_plugin_mem_is_store(info)) {
    stored_bytes += bytes;
  } else {
    loaded_bytes += bytes;
  }
}

// Loads and stores, in the "Main encoding table of the A64 instruction set".
static bool uses_memory(uint32_t code) {
  return ((code >> 25) & 0x5) == 0x4;
}

static void block_is_new(PluginId id, struct qemu_plugin_tb* tb) {
  const size_t count = qemu_plugin_tb_n_insns(tb);
  struct Block* block = calloc(1, sizeof *block + count * sizeof block->codes[0]);  // as long as the program
  (void)id;
  if (block == NULL) abort();
  block->next = blocks;
  blocks = block;
  block->count = count;
  for (size_t i = 0; i < count; ++i) {
    struct qemu_plugin_insn* instruction = qemu_plugin_tb_get_insn(tb, i);
    memcpy(&block->codes[i], qemu_plugin_insn_data(instruction), sizeof block->codes[i]);
    if (uses_memory(block->codes[i]))
      qemu_plugin_register_vcpu_mem_cb(instruction, memory_is_used, NO_REGISTERS, READS_AND_WRITES, NULL);
  }
  qemu_plugin_register_vcpu_tb_exec_cb(tb, block_runs, NO_REGISTERS, block);
}

static void program_ends(PluginId id, void* data) {
  FILE* file = fopen(out, "w");
  (void)id, (void)data;
  if (file == NULL) {
    perror(out);
    return;
  }
  fprintf(file, "{\"loaded_bytes\":%llu,\"stored_bytes\":%llu,\"blocks\":[", (unsigned long long)loaded_bytes,
          (unsigned long long)stored_bytes);
  for (const struct Block* block = blocks; block != NULL; block = block->next) {
    fprintf(file, "[%llu,\"", (unsigned long long)block->executed);
    for (size_t i = 0; i < block->count; ++i) fprintf(file, "%08x", block->codes[i]);
    fprintf(file, "\"]%s\n", block->next != NULL ? "," : "");
  }
  fprintf(file, "]}\n");
  if (fclose(file) != 0) perror(out);
}

// QEMU's names.
__attribute__((visibility("default"))) int qemu_plugin_version = 1;
__attribute__((visibility("default"))) int qemu_plugin_install(PluginId id, const void* info, int count,
                                                               char** arguments) {
  (void)info;
  if (count != 1 || strncmp(arguments[0], "out=", 4) != 0 || strlen(arguments[0]) >= sizeof out) {
    fprintf(stderr, "frame_counts: out=FILE expected\n");
    return 1;
  }
  strcpy(out, arguments[0] + 4);
  qemu_plugin_register_vcpu_tb_trans_cb(id, block_is_new);
  qemu_plugin_register_atexit_cb(id, program_ends, NULL);
  return 0;
}
