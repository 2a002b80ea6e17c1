// SPDX-License-Identifier: Apache-2.0
//
// What the limits of a pin display leave of a frame, found pin by pin before each drive period (docs/pin_display.md).
//
//   total  ticks in which a pin was driven since 8 eighths of the window ago or longer, a period counts a tick more
//   run    eighths that the frames have had the pin on, at most 15
//   may    level > 0, total + length + 2 <= duty, run <= watchdog, fewer than `most` pins before it that may
//   out    may, not silent and in a burst: min(level, top), else 0
//
// A pass, a pin a clock, begins with begin_i (a period), after off_i (it ends early), and while the display is off with
// turn_i. It charges the period that ends; turn_i moves the window on in the next pass. So of any eight eighths a pin is
// driven for `duty` ticks at most. A reset forgets the past.
//
//   clock  1, 2              3          4           5
//          read both memories window    charge      levels leave, in order, from the 5th clock after begin_i on
//
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

  input  logic [7:0]               cfg_top_i,
  input  logic [11:0]              cfg_most_i,
  input  logic [15:0]              cfg_duty_i,
  input  logic [3:0]               cfg_watchdog_i,

  input  logic                     running_i,
  input  logic                     begin_i,         // the rest of msn_pin_phase
  input  logic                     off_i,
  input  logic                     silent_i,
  input  logic                     burst_i,
  input  logic [12:0]              length_i,
  input  logic                     turn_i,

  output logic                     frame_begun_o,   // to msn_image_store, which answers after two clocks
  output logic                     frame_done_o,
  output logic [PlaceBits-1:0]     frame_place_o,
  input  logic [7:0]               frame_level_i,

  output logic                     out_valid_o,     // levels of a period
  output logic [AmplitudeBits-1:0] out_level_o,
  output logic                     out_last_o,

  output logic                     busy_o,          // a pass is under way or about to begin
  output logic                     idle_o,          // none is, and none waits
  output logic [PinBits-1:0]       pins_o,          // that the period drives
  output logic [PinBits-1:0]       limited_o        // that a limit keeps off
);

  if (Pins < 2 || Pins > 4095) begin : gen_check_pins
    $fatal(1, "msn_pin_limits: Pins = %0d must lie in 2 .. 4095", Pins);
  end
  if (AmplitudeBits < 1 || AmplitudeBits > 6) begin : gen_check_amplitude_bits
    $fatal(1, "msn_pin_limits: AmplitudeBits = %0d must lie in 1 .. 6", AmplitudeBits);
  end

  localparam int unsigned          StateBits = 16 + 13 + 4 + 1;
  localparam logic [PlaceBits-1:0] LastPlace = PlaceBits'(Pins - 1);
  localparam logic [7:0]           Top       = 8'((1 << AmplitudeBits) - 1);

  // Passes.
  logic                 reading, compose, turning, due, closing, fresh, go, go_q, final_place;
  logic [3:0]           valid, last;      // of the four stages
  logic [PlaceBits-1:0] place, ring_place, write_place;
  logic [3:0]           eighths;          // since the reset, up to 8: before, the ring holds nothing
  logic [2:0]           eighth;
  assign final_place   = place == LastPlace;
  assign go            = begin_i || (!reading && valid == '0 && (closing || (!running_i && due)));
  assign busy_o        = reading || valid != '0 || closing;
  assign idle_o        = !busy_o && !due;
  assign frame_place_o = place;
  assign frame_begun_o = reading || valid[1:0] != '0;
  always_ff @(posedge clk_i) begin
    due     <= turn_i || (due && !go);
    closing <= off_i || (closing && !(go && !begin_i));
    go_q    <= go;
    if (go) begin
      reading <= 1'b1;
      compose <= begin_i;
      turning <= due;
    end else if (final_place) begin
      reading <= 1'b0;
    end
    place        <= (reading && !final_place) ? place + 1'b1 : '0;
    valid        <= {valid[2:0], reading};
    last         <= {last[2:0], reading && final_place};
    frame_done_o <= compose && last[1];
    if (last[3]) fresh <= 1'b0;
    if (last[3] && turning) begin
      eighth <= eighth + 1'b1;
      if (!eighths[3]) eighths <= eighths + 1'b1;
    end
    if (rst_i) begin
      due          <= 1'b0;
      closing      <= 1'b0;
      go_q         <= 1'b0;
      reading      <= 1'b0;
      place        <= '0;
      valid        <= '0;
      last         <= '0;
      frame_done_o <= 1'b0;
      fresh        <= 1'b1;
      eighths      <= '0;
      eighth       <= '0;
    end
  end

  // What is kept of each pin, and a ring of what was charged to each eighth.
  logic [StateBits-1:0] kept;
  logic [12:0]          oldest, old;
  logic [15:0]          total, total_a, total_b, charge, allowed;
  logic [12:0]          part, part_a, part_b;  // of total: this eighth's
  logic [3:0]           run, run_a, run_b;
  logic                 on, on_a, drive, some_allowed, asks, may;
  logic [7:0]           level_a, level_b, top;
  assign {total, part, run, on} = fresh ? '0 : kept;
  assign old = (turning && eighths[3]) ? oldest : '0;
  always_ff @(posedge clk_i) begin
    if (go_q) begin  // off_i may come in a pass
      charge       <= 16'(length_i) + 1'b1;
      allowed      <= cfg_duty_i - 16'(length_i) - 16'd2;
      some_allowed <= cfg_duty_i >= 16'(length_i) + 16'd2;
      top          <= cfg_top_i < Top ? cfg_top_i : Top;
    end
    if (valid[1]) ring_place <= last[1] ? '0 : ring_place + 1'b1;
    total_a <= total - 16'(old);
    part_a  <= turning ? '0 : part;
    run_a   <= !compose ? run : frame_level_i == '0 ? '0 : run + 4'(turning && run != '1);
    on_a    <= on;
    level_a <= frame_level_i;
    total_b <= total_a + (on_a ? charge : '0);
    part_b  <= part_a + (on_a ? charge[12:0] : '0);
    run_b   <= run_a;
    level_b <= level_a;
    if (rst_i) ring_place <= '0;
  end
  msn_ram #(.Words(Pins), .Width(StateBits)) u_pins (
    .clk_i, .write_i(valid[3]), .write_address_i(write_place), .write_data_i({total_b, part_b, run_b, drive}),
    .read_i(1'b1), .read_address_i(place), .out_data_o(kept)
  );
  msn_ram #(.Words(8 << PlaceBits), .Width(13)) u_eighths (
    .clk_i, .write_i(valid[1] && turning), .write_address_i({eighth, ring_place}), .write_data_i(part),
    .read_i(1'b1), .read_address_i({eighth, place}), .out_data_o(oldest)
  );

  // The levels that leave.
  logic [PinBits-1:0] allowed_pins, driven, kept_off;
  assign asks        = level_b != '0;
  assign may         = asks && some_allowed && total_b <= allowed && run_b <= cfg_watchdog_i && top != '0
                       && 12'(allowed_pins) < cfg_most_i;
  assign drive       = may && compose && burst_i && !silent_i;
  assign out_valid_o = valid[3] && compose;
  assign out_last_o  = last[3];
  assign out_level_o = !drive ? '0 : AmplitudeBits'(level_b < top ? level_b : top);
  always_ff @(posedge clk_i) begin
    if (valid[3]) begin
      write_place  <= last[3] ? '0 : write_place + 1'b1;
      allowed_pins <= last[3] ? '0 : allowed_pins + PinBits'(may);
      driven       <= last[3] ? '0 : driven + PinBits'(drive);
      kept_off     <= last[3] ? '0 : kept_off + PinBits'(asks && !may);
      if (last[3]) begin
        pins_o <= driven + PinBits'(drive);
        if (compose) limited_o <= kept_off + PinBits'(asks && !may);
      end
    end
    if (rst_i) begin
      write_place  <= '0;
      allowed_pins <= '0;
      driven       <= '0;
      kept_off     <= '0;
      pins_o       <= '0;
      limited_o    <= '0;
    end
  end

  // The two limits, of what leaves: pins at once, and the duty with this period's ticks.
  msn_check u_most (
    .clk_i, .rst_i, .wrong_i(valid[3] && drive && 12'(driven) >= cfg_most_i)
  );
  msn_check u_duty (
    .clk_i, .rst_i, .wrong_i(valid[3] && drive && (!some_allowed || total_b > allowed))
  );

endmodule
