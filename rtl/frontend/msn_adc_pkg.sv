// SPDX-License-Identifier: Apache-2.0
//
// What msn_adc_spi must know of each converter: the shape of its frame and its limits in ns.
// Adding a part: one line in each function, and the same in model/meissner/frontend/adc_spi.py.
// Every figure and where it comes from: docs/adc.md

package msn_adc_pkg;

  // The pads' and the board's delay, out with SCLK and back with DOUT, on top of the part's own.
  localparam int unsigned RoundTripNs = 7;

  function automatic bit known(int unsigned part);
    known = part == msn_pkg::AdcMcp3208 || part == msn_pkg::AdcAd7606;
  endfunction

  // Bits of one code.
  function automatic int unsigned data_bits(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: data_bits = 16;
      default:            data_bits = 12;
    endcase
  endfunction

  // SCLK periods per code: command and null bits first, the code last.
  function automatic int unsigned word_bits(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: word_bits = 16;
      default:            word_bits = 19;
    endcase
  endfunction

  // The code is two's complement.
  function automatic bit is_signed(int unsigned part);
    is_signed = part == msn_pkg::AdcAd7606;
  endfunction

  // CS goes high after every channel, each channel is asked for by a command; otherwise one CS frame holds all.
  function automatic bit cs_per_channel(int unsigned part);
    cs_per_channel = part == msn_pkg::AdcMcp3208;
  endfunction

  // CONVST starts a conversion and BUSY falls when it ends; otherwise CS falling starts it.
  function automatic bit has_busy(int unsigned part);
    has_busy = part == msn_pkg::AdcAd7606;
  endfunction

  // SCLK rests high and DOUT changes on its rising edge; otherwise it rests low, and on its falling edge.
  function automatic bit idles_high(int unsigned part);
    idles_high = part == msn_pkg::AdcAd7606;
  endfunction

  // DOUT lanes, and the channels on each when all lanes are used.
  function automatic int unsigned max_lanes(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: max_lanes = 2;
      default:            max_lanes = 1;
    endcase
  endfunction

  function automatic int unsigned lane_channels(int unsigned part);
    lane_channels = 8 / max_lanes(part);
  endfunction

  function automatic int unsigned sclk_max_khz(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: sclk_max_khz = 14_500;
      default:            sclk_max_khz = 2_000;
    endcase
  endfunction

  // Below it the sample droops before its last bit is out.
  function automatic int unsigned sclk_min_khz(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: sclk_min_khz = 1;
      default:            sclk_min_khz = 10;
    endcase
  endfunction

  // Right for the whole supply range: the MCP3208 reaches its 2 MHz only at 5 V.
  function automatic int unsigned sclk_default_khz(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: sclk_default_khz = 14_500;
      default:            sclk_default_khz = 1_000;
    endcase
  endfunction

  // From CS or from the SCLK edge that launches a bit until DOUT is right, at most.
  function automatic int unsigned access_ns(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: access_ns = 30;
      default:            access_ns = 200;
    endcase
  endfunction

  // From convert start until BUSY falls, at most.
  function automatic int unsigned conversion_max_ns(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606: conversion_max_ns = 4_200;
      default:            conversion_max_ns = 0;
    endcase
  endfunction

  // Clocks in half an SCLK period: SCLK is not above sclk_khz, and DOUT, which is sampled one clock before
  // the bit's 2*half clocks end, has had its access time and the round trip.
  function automatic int unsigned half_clocks(int unsigned part, int unsigned clk_khz, int unsigned sclk_khz);
    int unsigned by_rate;
    int unsigned by_access;
    by_rate     = (sclk_khz < 1) ? 1 : (clk_khz + 2 * sclk_khz - 1) / (2 * sclk_khz);
    by_access   = (msn_pkg::clocks_of_ns(access_ns(part) + RoundTripNs, clk_khz) + 2) / 2;
    half_clocks = (by_rate > by_access) ? by_rate : by_access;
  endfunction

endpackage
