// SPDX-License-Identifier: Apache-2.0
//
// Properties of each converter that msn_adc_spi needs: the form of its SPI frame and its timing limits in ns.
// To add a part: a line in each function, known() among them, where the last branch does not suit it, and the same in
// model/meissner/twins/frontend/adc_spi.py. docs/adc.md lists every other place, and all figures with their sources.

package msn_adc_pkg;

  // Delay of pads and board, out with SCLK and back with DOUT, in addition to the part's own.
  localparam int unsigned RoundTripNs = 7;

  function automatic bit known(int unsigned part);
    known = part == msn_pkg::AdcMcp3208 || has_busy(part) || has_tag(part);
  endfunction

  // MAX11123, MAX11124, MAX11125 differ only in the bits of a code, MAX11131 has a faster clock. Each answer is the
  // channel's number in four bits and the code, left-aligned, in twelve; it answers the command in the word before.
  function automatic bit has_tag(int unsigned part);
    has_tag = (part >= msn_pkg::AdcMax11123 && part <= msn_pkg::AdcMax11125) || part == msn_pkg::AdcMax11131;
  endfunction

  // Bits of one code.
  function automatic int unsigned data_bits(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606:   data_bits = 16;
      msn_pkg::AdcAd7606c:  data_bits = 16;
      msn_pkg::AdcMax11123: data_bits = 8;
      msn_pkg::AdcMax11124: data_bits = 10;
      default:              data_bits = 12;
    endcase
  endfunction

  // SCLK periods per code: command and null bits first, the code last.
  function automatic int unsigned word_bits(int unsigned part);
    case (part)
      msn_pkg::AdcMcp3208: word_bits = 19;
      default:             word_bits = 16;
    endcase
  endfunction

  // The number of last bits of a word that are kept; as many bits of the command are sent.
  function automatic int unsigned kept_bits(int unsigned part);
    kept_bits = has_tag(part) ? 16 : data_bits(part);
  endfunction

  // The command sent with word `index` of a frame, from bit 15 on.
  //   MCP3208   start bit, single-ended, channel
  //   MAX111xx  mode control: manual scan of the channel, channel number in the answer
  //   AD7606    none: it has no DIN
  //   AD7606C   zeros: it stays in the mode in which it sends conversions
  function automatic logic [15:0] command(int unsigned part, logic [2:0] index);
    case (part)
      msn_pkg::AdcMcp3208: command = {2'b11, index, 11'd0};
      msn_pkg::AdcAd7606, msn_pkg::AdcAd7606c: command = '0;
      default:             command = {5'b00001, 1'b0, index, 7'b0000100};
    endcase
  endfunction

  // Words that set the part up, each in its own CS frame, before the first conversion.
  function automatic int unsigned setup_words(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606c: setup_words = 8;
      default:             setup_words = has_tag(part) ? 5 : 0;
    endcase
  endfunction

  function automatic logic [15:0] setup_word(int unsigned part, int unsigned lanes, logic [2:0] index);
    if (part == msn_pkg::AdcAd7606c) begin  // read bit 14, register 13:8, value 7:0
      case (index)
        3'd0:    setup_word = 16'h4200;  // read a register: until the last word, words are for registers
        3'd1:    setup_word = {11'h010, 2'($clog2(lanes)), 3'd0};  // configuration: 1, 2, 4 or 8 DOUT lanes
        3'd2:    setup_word = 16'h0311;  // range of channels 0 and 1: +-5 V, single-ended
        3'd3:    setup_word = 16'h0411;  // 2 and 3
        3'd4:    setup_word = 16'h0511;  // 4 and 5
        3'd5:    setup_word = 16'h0611;  // 6 and 7
        3'd6:    setup_word = 16'h07ff;  // bandwidth: wide on every channel
        default: setup_word = 16'h0000;  // send conversions
      endcase
    end else if (has_tag(part)) begin
      case (index)
        3'd0:    setup_word = 16'h0040;  // mode control: reset all registers to their defaults
        3'd1:    setup_word = 16'h8000;  // configuration: external reference, no average, always on, no echo
        3'd2:    setup_word = 16'h8800;  // unipolar: every input single-ended, against ground
        3'd3:    setup_word = 16'h9000;  // bipolar: none
        default: setup_word = 16'h9800;  // range: the setting for no bipolar inputs
      endcase
    end else begin
      setup_word = '0;
    end
  endfunction

  // The part has a RESET pin: high for reset_ns after rst_i, then low for start_ns before the first word or conversion.
  // A part without RESET that needs a setup is left idle for both times.
  function automatic bit has_reset(int unsigned part);
    has_reset = has_busy(part);
  endfunction

  function automatic int unsigned reset_ns(int unsigned part);
    case (part)
      msn_pkg::AdcMcp3208: reset_ns = 0;
      msn_pkg::AdcAd7606c: reset_ns = 3_300;
      default:             reset_ns = 100;
    endcase
  endfunction

  function automatic int unsigned start_ns(int unsigned part);
    case (part)
      msn_pkg::AdcMcp3208: start_ns = 0;
      msn_pkg::AdcAd7606c: start_ns = 275_000;
      default:             start_ns = 100;
    endcase
  endfunction

  // The code is two's complement.
  function automatic bit is_signed(int unsigned part);
    is_signed = has_busy(part);
  endfunction

  // CS goes high after every word, each with its command; otherwise one CS frame has all words, without commands.
  function automatic bit cs_per_channel(int unsigned part);
    cs_per_channel = part != msn_pkg::AdcAd7606;
  endfunction

  // CONVST starts a conversion and BUSY falls when it ends; otherwise CS falling starts it.
  function automatic bit has_busy(int unsigned part);
    has_busy = part == msn_pkg::AdcAd7606 || part == msn_pkg::AdcAd7606c;
  endfunction

  // SCLK rests high; otherwise low. DOUT changes when SCLK returns to rest, or (leads) when it leaves rest.
  function automatic bit idles_high(int unsigned part);
    idles_high = part != msn_pkg::AdcMcp3208;
  endfunction

  function automatic bit leads(int unsigned part);
    leads = has_tag(part);
  endfunction

  // DOUT lanes: a power of two up to this. The channels on each, in order: the first lane has the first ones.
  function automatic int unsigned max_lanes(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606:  max_lanes = 2;
      msn_pkg::AdcAd7606c: max_lanes = 8;
      default:             max_lanes = 1;
    endcase
  endfunction

  function automatic int unsigned lane_channels(int unsigned lanes);
    lane_channels = (lanes < 1 || lanes > 8) ? 1 : 8 / lanes;
  endfunction

  function automatic int unsigned sclk_max_khz(int unsigned part);
    case (part)
      msn_pkg::AdcMcp3208: sclk_max_khz = 2_000;
      msn_pkg::AdcAd7606:  sclk_max_khz = 17_000;
      msn_pkg::AdcAd7606c: sclk_max_khz = 60_000;
      msn_pkg::AdcMax11131: sclk_max_khz = 48_000;
      default:             sclk_max_khz = 16_000;
    endcase
  endfunction

  // At slower SCLK the sample droops before its last bit is out.
  function automatic int unsigned sclk_min_khz(int unsigned part);
    case (part)
      msn_pkg::AdcMcp3208: sclk_min_khz = 10;
      msn_pkg::AdcAd7606, msn_pkg::AdcAd7606c: sclk_min_khz = 1;
      msn_pkg::AdcMax11131: sclk_min_khz = 480;
      default:             sclk_min_khz = 160;
    endcase
  endfunction

  // Valid for the entire supply range: the MCP3208 reaches its 2 MHz only at 5 V, the AD7606 its 17 MHz at 3.3 V.
  function automatic int unsigned sclk_default_khz(int unsigned part);
    case (part)
      msn_pkg::AdcMcp3208: sclk_default_khz = 1_000;
      msn_pkg::AdcAd7606:  sclk_default_khz = 14_500;
      msn_pkg::AdcAd7606c: sclk_default_khz = 60_000;
      msn_pkg::AdcMax11131: sclk_default_khz = 48_000;
      default:             sclk_default_khz = 16_000;
    endcase
  endfunction

  // From CS, or from the SCLK edge that launches a bit, until DOUT is valid, at most.
  function automatic int unsigned access_ns(int unsigned part);
    case (part)
      msn_pkg::AdcMcp3208: access_ns = 200;
      msn_pkg::AdcAd7606:  access_ns = 30;
      msn_pkg::AdcAd7606c: access_ns = 20;
      default:             access_ns = 17;
    endcase
  endfunction

  // From convert start until BUSY falls, at most.
  function automatic int unsigned conversion_max_ns(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606:  conversion_max_ns = 4_200;
      msn_pkg::AdcAd7606c: conversion_max_ns = 700;
      default:             conversion_max_ns = 0;
    endcase
  endfunction

  // The same, at least: converters that start together end up to the difference apart.
  function automatic int unsigned conversion_min_ns(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606:  conversion_min_ns = 3_450;
      msn_pkg::AdcAd7606c: conversion_min_ns = 500;
      default:             conversion_min_ns = 0;
    endcase
  endfunction

  // From the end of a read to the next fall of BUSY, at least.
  function automatic int unsigned read_end_ns(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606, msn_pkg::AdcAd7606c: read_end_ns = 25;
      default:             read_end_ns = 0;
    endcase
  endfunction

  // From convert start to convert start, at least.
  function automatic int unsigned cycle_min_ns(int unsigned part);
    case (part)
      msn_pkg::AdcAd7606:  cycle_min_ns = 5_000;
      msn_pkg::AdcAd7606c: cycle_min_ns = 1_000;
      default:             cycle_min_ns = 0;
    endcase
  endfunction

  // Width of the watchdog: twice the longest conversion, rounded up to a power of two to save a comparator.
  // read_during: it ends 3 clocks after the longest conversion.
  function automatic int unsigned watch_bits(int unsigned part, int unsigned clk_khz, bit read_during);
    watch_bits = msn_pkg::index_width(read_during ? busy_clocks(part, clk_khz) + 4 :
                                      msn_pkg::clocks_of_ns(2 * conversion_max_ns(part), clk_khz));
  endfunction

  // Clocks in half an SCLK period: SCLK does not exceed sclk_khz, and DOUT, sampled one clock before the bit's
  // 2*half clocks end, has had time for access and round trip.
  function automatic int unsigned half_clocks(int unsigned part, int unsigned clk_khz, int unsigned sclk_khz);
    int unsigned by_rate;
    int unsigned by_access;
    by_rate     = (sclk_khz < 1) ? 1 : (clk_khz + 2 * sclk_khz - 1) / (2 * sclk_khz);
    by_access   = (msn_pkg::clocks_of_ns(access_ns(part) + RoundTripNs, clk_khz) + 2) / 2;
    half_clocks = (by_rate > by_access) ? by_rate : by_access;
  endfunction

  // Words of each lane in a frame; the first word of a tagged part is only a command.
  function automatic int unsigned frame_words(int unsigned part, int unsigned channels, int unsigned lanes);
    frame_words = ((lanes > 1) ? lane_channels(lanes) : channels) + 32'(has_tag(part));
  endfunction

  // Clocks from one CS frame of `words` words to the next.
  function automatic int unsigned cs_clocks(int unsigned part, int unsigned half, int unsigned words);
    cs_clocks = 2 * half * (word_bits(part) * words + 1) + half * 32'(leads(part));
  endfunction

  // Clocks from the start of a frame's first word to the end of its last one.
  function automatic int unsigned read_clocks(int unsigned part, int unsigned half, int unsigned words);
    read_clocks = cs_per_channel(part) ? words * cs_clocks(part, half, 1) : cs_clocks(part, half, words);
  endfunction

  // The clocks after convert start in which BUSY may fall: the last one, and the first one at whose end it may be low.
  function automatic int unsigned busy_clocks(int unsigned part, int unsigned clk_khz);
    busy_clocks = conversion_max_ns(part) * clk_khz / 1_000_000;
  endfunction

  function automatic int unsigned busy_least(int unsigned part, int unsigned clk_khz);
    busy_least = msn_pkg::clocks_of_ns(conversion_min_ns(part), clk_khz) - 1;
  endfunction

  // A frame read while the next one is converted: clocks from the start of its transfer in which no tick starts a
  // conversion, whose BUSY could fall less than read_end_ns after the transfer, or before the shifter rests.
  function automatic int unsigned guard_clocks(int unsigned part, int unsigned clk_khz, int unsigned half,
                                               int unsigned words);
    int unsigned ends;
    int unsigned least;
    int unsigned done;
    ends         = read_clocks(part, half, words) - 2 * half;
    least        = (conversion_min_ns(part) - read_end_ns(part)) * clk_khz / 1_000_000;
    guard_clocks = (ends > least) ? ends - least : 1;
    done         = read_clocks(part, half, words);
    least        = busy_least(part, clk_khz) + 2;
    if (done > least && done - least > guard_clocks) guard_clocks = done - least;
  endfunction

  // The same: clocks after a trigger from which on samples and losses are of its conversion. A loss is known after the
  // watchdog, a sample after the first word of the shortest conversion.
  function automatic int unsigned overlap_clocks(int unsigned part, int unsigned clk_khz, int unsigned half);
    overlap_clocks = busy_least(part, clk_khz) + 3 + 2 * half * word_bits(part);
    if (overlap_clocks > busy_clocks(part, clk_khz) + 4) overlap_clocks = busy_clocks(part, clk_khz) + 4;
  endfunction

  // Clocks from convert start until no channel samples its input any more: the inputs may change then.
  function automatic int unsigned hold_clocks(int unsigned part, int unsigned channels, int unsigned clk_khz,
                                              int unsigned half);
    case (part)
      msn_pkg::AdcMcp3208: hold_clocks = (channels - 1) * cs_clocks(part, half, 1) + 12 * half + 1;
      msn_pkg::AdcAd7606, msn_pkg::AdcAd7606c: hold_clocks = msn_pkg::clocks_of_ns(25, clk_khz) + 1;
      default:             hold_clocks = channels * cs_clocks(part, half, 1) + 1;
    endcase
  endfunction

  // Clocks from convert start to convert start: enough for every frame to end and its samples to leave to a consumer
  // that is always ready, and for as many substitutes of a lost frame's samples, which take 4 clocks more.
  // read_during: the transfer may go on while the next conversion runs.
  function automatic int unsigned cycle_clocks(int unsigned part, int unsigned channels, int unsigned lanes,
                                               int unsigned clk_khz, int unsigned half, bit read_during);
    int unsigned words;
    int unsigned busy;
    int unsigned other;
    int unsigned extra;  // clocks in which samples that came together leave after the last word
    words = frame_words(part, channels, lanes);
    extra = (lanes > 1) ? channels - words : 0;
    busy  = busy_clocks(part, clk_khz);
    if (!has_busy(part)) begin
      cycle_clocks = read_clocks(part, half, words) + (has_tag(part) ? channels + 4 : 1);
    end else begin
      cycle_clocks = msn_pkg::clocks_of_ns(cycle_min_ns(part), clk_khz);
      if (read_during) begin
        other = busy + 3 + guard_clocks(part, clk_khz, half, words);
        if (other > cycle_clocks) cycle_clocks = other;
        other = busy - busy_least(part, clk_khz) + read_clocks(part, half, words) - 2 * half + extra + 1;
        if (other > cycle_clocks) cycle_clocks = other;
        other = busy + 5;
        if (other > cycle_clocks) cycle_clocks = other;
        other = busy + read_clocks(part, half, words) + channels + 7 - overlap_clocks(part, clk_khz, half);
        if (other > cycle_clocks) cycle_clocks = other;
      end else begin
        other = busy + 4 + read_clocks(part, half, words);
        if (other > cycle_clocks) cycle_clocks = other;
        other = other - 2 * half + extra;
        if (other > cycle_clocks) cycle_clocks = other;
        other = (1 << watch_bits(part, clk_khz, 1'b0)) + channels + 4;
        if (other > cycle_clocks) cycle_clocks = other;
      end
    end
  endfunction

endpackage
