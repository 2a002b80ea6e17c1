/* SPDX-License-Identifier: Apache-2.0
 * Made by tools/registers.py from rtl/registers.rdl: change that, then `make registers`. */
#ifndef MSN_REGISTERS_H
#define MSN_REGISTERS_H

#define MSN_FEATURE_ADC (1u << 0)
#define MSN_FEATURE_SLIP (1u << 1)

/* What this core is */
#define MSN_CORE_ID 0x000u
#define MSN_CORE_VERSION 0x004u
#define MSN_CORE_VERSION_PATCH_SHIFT 0
#define MSN_CORE_VERSION_PATCH_BITS 8
#define MSN_CORE_VERSION_MINOR_SHIFT 8
#define MSN_CORE_VERSION_MINOR_BITS 8
#define MSN_CORE_VERSION_MAJOR_SHIFT 16
#define MSN_CORE_VERSION_MAJOR_BITS 16
#define MSN_CORE_FEATURES 0x008u
#define MSN_CORE_SIZE 0x00cu
#define MSN_CORE_SIZE_ROWS_SHIFT 0
#define MSN_CORE_SIZE_ROWS_BITS 16
#define MSN_CORE_SIZE_COLUMNS_SHIFT 16
#define MSN_CORE_SIZE_COLUMNS_BITS 16
#define MSN_CORE_CLK_KHZ 0x010u
#define MSN_CORE_SCRATCH 0x014u

/* ADC master */
#define MSN_ADC_ENABLE 0x100u
#define MSN_ADC_PERIOD 0x104u
#define MSN_ADC_DROPPED 0x108u
#define MSN_ADC_OVERRUN 0x10cu
#define MSN_ADC_TIMEOUT 0x110u
#define MSN_ADC_OVER_RANGE 0x114u

/* Slip of each channel */
#define MSN_SLIP_THRESHOLD 0x200u
#define MSN_SLIP_GROSS_THRESHOLD 0x204u
#define MSN_SLIP_CONTACT_LEVEL 0x208u
#define MSN_SLIP_RELEASE_LEVEL 0x20cu
#define MSN_SLIP_CONTACT_RISES 0x210u
#define MSN_SLIP_HOLD 0x214u
#define MSN_SLIP_REFRACTORY 0x218u
#define MSN_SLIP_BLANK 0x21cu
#define MSN_SLIP_DAMAGED 0x220u
#define MSN_SLIP_BLANKED 0x224u

#endif
