// SPDX-License-Identifier: Apache-2.0
//
// What the limits of a pin display leave of a frame, found pin by pin before each drive period (docs/pin_display.md).
//
//   sum    ticks in which a pin was driven, mod 2^16; a period counts one more
//   total  sum less what it was as the oldest of eight sevenths began: of this one of the window and the seven before
//   run    sevenths that have ended while the frames had the pin on, at most 15
//   may    level > 0, total + length + 2 <= duty, run <= watchdog, fewer than `most` pins before it that may
//   out    may, not silent and in a burst: min(level, top), else 0
//
// A pass, a pin a clock, begins with begin_i (a period), after off_i (it ends early), and while the display is off with
// turn_i. It charges the period that ends; turn_i moves the window on in the next pass. So in any seven sevenths a pin is
// driven for `duty` ticks at most. A reset forgets the past. An upset of a sum moves both, so it leaves with the window.
//
//   clock  1, 2               3       4       5
//          read both memories window  charge  levels leave, in order, from the 5th clock after begin_i on
//
// Names in _n are inverted: x <= y where y + ~x + 1 carries, x < y where y + ~x does, and an iCE40's carry chain has no
// inverter; yosys would spend a cell a bit on each.
// Error: none.
// Model: model/meissner/twins/actuate/pin_display.py

module msn_pin_limits #(
  parameter  int unsigned Pins          = 100,
  parameter  int unsigned AmplitudeBits = 4,
  localparam int unsigned PlaceBits     = msn_pkg::index_width(Pins),
  localparam int unsigned PinBits       = $clog2(Pins + 1)
) (
  input  logic                     clk_i,
  input  logic                     rst_i,

  input  logic [AmplitudeBits-1:0] cfg_top_i,
  input  logic [11:0]              cfg_most_i,
  input  logic [15:0]              cfg_duty_i,
  input  logic [3:0]               cfg_watchdog_i,

  input  logic                     running_i,
  input  logic                     begin_i,         // the rest of msn_pin_phase
  input  logic                     off_i,
  input  logic                     silent_i,
  input  logic                     burst_i,
  input  logic [12:0]              length_i,        // with begin_i, and after off_i
  input  logic                     turn_i,

  output logic                     frame_begun_o,   // to msn_image_store, which answers after two clocks
  output logic                     frame_done_o,
  output logic [PlaceBits-1:0]     frame_place_o,
  input  logic [AmplitudeBits-1:0] frame_level_i,

  output logic                     out_valid_o,     // levels of a period
  output logic [AmplitudeBits-1:0] out_level_o,
  output logic                     out_last_o,

  output logic                     busy_o,          // a pass is under way or about to begin
  output logic                     idle_o,          // none is, and none waits
  output logic [PinBits-1:0]       pins_o,          // that the period drives
  output logic                     limited_o        // a limit keeps one off
);

  if (Pins < 2 || Pins > 4095) begin : gen_check_pins
    $fatal(1, "msn_pin_limits: Pins = %0d must lie in 2 .. 4095", Pins);
  end
  if (AmplitudeBits < 1 || AmplitudeBits > 6) begin : gen_check_amplitude_bits
    $fatal(1, "msn_pin_limits: AmplitudeBits = %0d must lie in 1 .. 6", AmplitudeBits);
  end

  localparam int unsigned          TotalBits = 16;
  localparam int unsigned          StateBits = TotalBits + 4 + 1;
  localparam logic [PlaceBits-1:0] LastPlace = PlaceBits'(Pins - 1);

  // Passes.
  logic                 reading, compose, turning, due, closing, fresh, go, final_place;
  logic [3:0]           valid, last;      // of the four stages
  logic [PlaceBits-1:0] place, write_place;
  logic [2:0]           seventh;
  logic                 full;             // eight sevenths have ended since reset: before, the ring is empty
  assign final_place   = place == LastPlace;
  assign go            = begin_i || (!reading && valid == '0 && (closing || (!running_i && due)));
  assign busy_o        = reading || valid != '0 || closing;
  assign idle_o        = !busy_o && !due;
  assign frame_place_o = place;
  assign frame_begun_o = reading || valid[1:0] != '0;
  always_ff @(posedge clk_i) begin
    due     <= turn_i || (due && !go);
    closing <= off_i || (closing && !go);
    if (go) begin
      reading <= 1'b1;
      compose <= begin_i;
      turning <= due;
      if (due) seventh <= seventh + 1'b1;
      if (due && seventh == '1) full <= 1'b1;
    end else if (final_place) begin
      reading <= 1'b0;
    end
    place        <= (reading && !final_place) ? place + 1'b1 : '0;
    valid        <= {valid[2:0], reading};
    last         <= {last[2:0], reading && final_place};
    frame_done_o <= compose && last[1];
    if (last[3]) fresh <= 1'b0;
    if (rst_i) begin
      due          <= 1'b0;
      closing      <= 1'b0;
      reading      <= 1'b0;
      place        <= '0;
      valid        <= '0;
      last         <= '0;
      frame_done_o <= 1'b0;
      fresh        <= 1'b1;
      seventh      <= '0;
      full         <= 1'b0;
    end
  end

  // What is kept of each pin, and a ring of its sums as the last eight sevenths began. Not a total of the window, from
  // which what leaves it is taken: an upset of that would stay.
  logic [StateBits-1:0]     kept;
  logic [2:0]               oldest;
  logic [TotalBits-1:0]     sum, sum_a, sum_b, begun, begun_b, total_a, total_b, total_b_n, charge, allowed;
  logic [3:0]               run_n, run_a_n, run_b_n;
  logic [TotalBits-1:0]     kept_begun;  // complements, which a subtraction needs
  logic                     on, on_a, drive, drives, none_allowed, asks, may;
  logic [AmplitudeBits-1:0] level_a_n, level_b_n;
  assign {sum, run_n, on} = kept;
  assign oldest  = seventh + 1'b1;
  assign begun   = ~kept_begun;
  assign total_b = ~total_b_n;
  always_ff @(posedge clk_i) begin
    if (go) charge <= TotalBits'(length_i) + 1'b1;  // off_i may come in a pass
    {none_allowed, allowed} <= {1'b0, cfg_duty_i} + {1'b1, ~charge};  // duty - charge - 1
    drives    <= compose && burst_i && !silent_i;
    total_a   <= full ? sum - begun : sum;
    sum_a     <= sum;
    on_a      <= on;
    run_a_n   <= run_n - 4'(compose && turning && run_n != '0);
    level_a_n <= ~frame_level_i;
    if (compose && frame_level_i == '0) run_a_n <= '1;
    if (fresh) begin
      total_a <= '0;
      sum_a   <= '0;
      run_a_n <= '1;
      on_a    <= 1'b0;
    end
    total_b_n <= ~(on_a ? total_a + charge : total_a);  // not + (on_a ? charge : 0): as many cells again
    sum_b     <= on_a ? sum_a + charge : sum_a;
    begun_b   <= ~sum_a;
    run_b_n   <= run_a_n;
    level_b_n <= level_a_n;
  end
  msn_ram #(.Words(Pins), .Width(StateBits)) u_pins (
    .clk_i, .write_i(valid[3]), .write_address_i(write_place), .write_data_i({sum_b, run_b_n, drive}),
    .read_i(1'b1), .read_address_i(place), .out_data_o(kept)
  );
  msn_ram #(.Words(8 << PlaceBits), .Width(TotalBits)) u_sevenths (
    .clk_i, .write_i(valid[3] && turning), .write_address_i({seventh, write_place}), .write_data_i(begun_b),
    .read_i(1'b1), .read_address_i({oldest, place}), .out_data_o(kept_begun)
  );

  // The levels that leave.
  logic [PinBits-1:0]       counted_p, counted_n, counts_n;
  logic [11:0]              counted;
  logic                     keeps_off, room, short, fewer, lower;
  logic [TotalBits:0]       unused_room;
  logic [4:0]               unused_short;
  logic [11:0]              unused_fewer;
  logic [AmplitudeBits-1:0] unused_lower;
  assign counted_p             = ~counted_n;
  assign counted               = 12'(counted_p);
  assign {room, unused_room}   = {1'b0, allowed, 1'b1} + {1'b0, total_b_n, 1'b1};       // total <= allowed
  assign {short, unused_short} = {1'b0, cfg_watchdog_i, 1'b1} + {1'b0, run_b_n, 1'b1};  // run <= watchdog
  assign {fewer, unused_fewer} = {1'b0, cfg_most_i} + {1'b0, ~counted};                 // counted < most
  assign {lower, unused_lower} = {1'b0, cfg_top_i} + {1'b0, level_b_n};                 // level < top
  assign asks        = level_b_n != '1;
  assign may         = asks && !none_allowed && room && short && cfg_top_i != '0 && fewer;
  assign drive       = may && drives;
  assign counts_n    = counted_n - PinBits'(may);
  assign out_valid_o = valid[3] && compose;
  assign out_last_o  = last[3];
  assign out_level_o = !drive ? '0 : lower ? ~level_b_n : cfg_top_i;
  always_ff @(posedge clk_i) begin
    if (valid[3]) begin
      write_place <= last[3] ? '0 : write_place + 1'b1;
      counted_n   <= last[3] ? '1 : counts_n;
      keeps_off   <= !last[3] && (keeps_off || (asks && !may));
      if (last[3]) begin
        pins_o    <= drives ? ~counts_n : '0;
        limited_o <= compose && (keeps_off || (asks && !may));
      end
    end
    if (rst_i) begin
      write_place <= '0;
      counted_n   <= '1;
      keeps_off   <= 1'b0;
      pins_o      <= '0;
      limited_o   <= 1'b0;
    end
  end

  // The two limits, of what leaves: pins at once, and the duty with this period's ticks.
  msn_check u_most (
    .clk_i, .rst_i, .wrong_i(valid[3] && drive && counted >= cfg_most_i)
  );
  msn_check u_duty (
    .clk_i, .rst_i, .wrong_i(valid[3] && drive && 17'(total_b) + 17'(charge) + 17'd1 > 17'(cfg_duty_i))
  );

  logic unused;
  assign unused = ^{unused_room, unused_short, unused_fewer, unused_lower};

endmodule
