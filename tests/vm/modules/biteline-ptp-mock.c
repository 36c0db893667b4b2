// SPDX-License-Identifier: MIT
// The kernel's mock PTP clock, which a network driver would make, made by a device of its own.
#include <linux/module.h>
#include <linux/platform_device.h>
#define CONFIG_PTP_1588_CLOCK_MOCK 1
#include "ptp_mock.c"

static struct platform_device *device;
static struct mock_phc *phc;

static int __init biteline_start(void)
{
	device = platform_device_register_simple("biteline-ptp-mock", -1, NULL, 0);
	if (IS_ERR(device))
		return PTR_ERR(device);
	phc = mock_phc_create(&device->dev);
	if (IS_ERR(phc)) {
		platform_device_unregister(device);
		return PTR_ERR(phc);
	}
	return 0;
}

static void __exit biteline_stop(void)
{
	mock_phc_destroy(phc);
	platform_device_unregister(device);
}

module_init(biteline_start);
module_exit(biteline_stop);
MODULE_LICENSE("GPL");
