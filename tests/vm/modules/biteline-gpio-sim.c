// SPDX-License-Identifier: MIT
// The kernel's gpio-sim and irq_sim in one module.  irq_to_desc() is not exported; the same through what is.
#include <linux/irq.h>
#include <linux/irqdesc.h>
#define irq_to_desc(number) irq_data_to_desc(irq_get_irq_data(number))
#include "irq_sim.c"
#include "gpio-sim.c"
