// SPDX-License-Identifier: MIT
// The kernel's DMA heaps and their system heap, which Debian leaves out, in one module.
#include <linux/init.h>
#include <linux/module.h>
#undef subsys_initcall
#define subsys_initcall(function)
#undef module_init
#define module_init(function)
#include "dma-heap.c"
#include "system_heap.c"

int init_module(void)
{
	const int fault = dma_heap_init();

	return fault ? fault : system_heap_create();
}
MODULE_IMPORT_NS(DMA_BUF);
