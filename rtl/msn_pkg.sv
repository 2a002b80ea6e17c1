// SPDX-License-Identifier: Apache-2.0
//
// Types, enums and width functions shared by every block. No logic.

package msn_pkg;

  // What the contact on one channel is doing.
  typedef enum logic [2:0] {
    None      = 3'd0,  // nothing touches the sensor
    Contact   = 3'd1,  // held, not slipping
    Incipient = 3'd2,  // parts of the contact slip, the object has not moved yet
    Gross     = 3'd3,  // the whole contact slips
    Release   = 3'd4   // the contact was lost a moment ago
  } slip_state_e;

  // The converters that msn_adc_spi can drive; AdcNone: samples enter on a stream.
  typedef enum int unsigned {
    AdcNone     = 0,
    AdcMcp3208  = 1,
    AdcAd7606   = 2,
    AdcMax11123 = 3,  // 8 bits; the family's other parts of 8 channels:
    AdcMax11124 = 4,  // 10 bits
    AdcMax11125 = 5,  // 12 bits
    AdcAd7606c  = 6,  // AD7606C-16
    AdcMax11131 = 7   // 12 bits, faster; inputs 0 to 7 of 16
  } adc_part_e;

  // How msn_am_demod finds the amplitude of a carrier.
  typedef enum int unsigned {
    DemodRectifier = 0,  // sum of absolute values
    DemodIq        = 1,  // root of I^2 + Q^2, exact
    DemodIqFast    = 2   // the same root, estimated by two straight lines
  } demod_form_e;

  // A decision about one channel.
  typedef struct packed {
    logic        raised;
    logic        last;  // of its frame
    slip_state_e state;
    logic [23:0] p2p;
    logic [15:0] id;
  } decision_t;

  // A change of a channel's state for the host, as msn_slip_changes finds it.
  typedef struct packed {
    logic        start;  // of a slip
    logic        late;   // the channel had this state in an earlier detail already
    slip_state_e told;   // the state that the host has of this channel
    slip_state_e state;
    logic [23:0] p2p;
    logic [15:0] id;
  } change_t;

  // What msn_slip reports to the grip reflex for each detail of one channel.
  typedef struct packed {
    logic        valid;
    logic        over;   // the peak-to-peak exceeds the threshold
    logic        last;   // of its window
    logic [15:0] id;
  } verdict_t;

  // A window's speed of shear for the grip reflex; ok = 0: the window has no valid speed.
  typedef struct packed {
    logic        valid;
    logic        ok;
    logic [2:0]  id;
    logic [15:0] speed;  // 2^-12 mm/s
  } shear_t;

  // A centre of pressure, in the formats of docs/link.md: x and y are signed.
  typedef struct packed {
    logic [23:0] x;
    logic [23:0] y;
    logic [39:0] load;
    logic        pressed;
  } cop_t;

  // A health report about one taxel.
  typedef struct packed {
    logic [23:0] id;
    logic [7:0]  faults;
  } health_t;

  // Another class that the forest decides for; 65535: none yet.
  typedef struct packed {
    logic [47:0] stamp;  // the time of the frame, or of the row
    logic [31:0] votes;
    logic [15:0] told;   // the class that the host has
    logic [15:0] label;
  } class_t;

  // Lines to an SDRAM.
  typedef struct packed {
    logic        cke;
    logic        cs_n;
    logic        ras_n;
    logic        cas_n;
    logic        we_n;
    logic [1:0]  ba;
    logic [12:0] a;
    logic [1:0]  dqm;
    logic [15:0] dq;
    logic        dq_enable;
  } sdram_t;

  // Bits of an index 0 .. count-1, at least one.
  function automatic int unsigned index_width(int unsigned count);
    index_width = (count > 1) ? $clog2(count) : 1;
  endfunction

  // Checks of parameters: lanes of a beat, rows or columns of an array, a power of two or 0.
  function automatic logic are_lanes(int unsigned count);
    are_lanes = count >= 1 && count <= 8;
  endfunction

  function automatic logic is_side(int unsigned count);
    is_side = count >= 1 && count <= 1024;
  endfunction

  function automatic logic is_power(int unsigned value);
    is_power = (value & (value - 1)) == 0;
  endfunction

  // Clocks that last at least `ns` nanoseconds, at least one.
  function automatic int unsigned clocks_of_ns(int unsigned ns, int unsigned clk_khz);
    clocks_of_ns = 32'((64'(ns) * 64'(clk_khz) + 64'd999_999) / 64'd1_000_000);
    if (clocks_of_ns < 1) clocks_of_ns = 1;
  endfunction

endpackage
