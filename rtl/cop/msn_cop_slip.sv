// SPDX-License-Identifier: Apache-2.0
//
// Slip from the total load and the centre of pressure: the load reported by conductive rubber drops by about
// half just before an object moves, and the centre moves slightly in the direction of slip. Over Lag samples:
//
//   over = (old - new) 256 > drop old  and  max(|dx|, |dy|) >= move      dx = x - old x, dy = y - old y
//
// if both samples are pressed, old load >= min_load and at least Lag samples came since reset. slip rises with
// `over` unless refractory (`raised` marks that sample), stays until `hold` samples in a row are not over, and
// then cannot rise for `refractory` samples. octant: of (dx, dy), counter-clockwise, 0 along +x, each 45 degrees
// wide around its axis or diagonal (limits at 53/128); 0 if nothing moved. Exact, no rounding.
//
//   clock  1                         2                   3           4       5
//          old, differences, drop old  magnitudes, compare  53 |d|, move  octant  state
//
// over, dx and dy are for users of the block alone, as engine rtl; the core sends slip, raised and octant.
// Latency 5 clocks, a sample a clock. An ordinary release lowers the load too: move > 0 excludes it.
// Error: none.
// Model: model/meissner/twins/cop/cop_slip.py

module msn_cop_slip #(
  parameter int unsigned Lag       = 16,
  parameter int unsigned TimerBits = 16
) (
  input  logic                 clk_i,
  input  logic                 rst_i,

  input  logic [7:0]           cfg_drop_i,        // 256ths of the old load
  input  logic [15:0]          cfg_move_i,        // Q2.14; 0: no movement required
  input  logic [15:0]          cfg_min_load_i,
  input  logic [TimerBits-1:0] cfg_hold_i,
  input  logic [TimerBits-1:0] cfg_refractory_i,

  input  logic                 in_valid_i,
  output logic                 in_ready_o,
  input  logic signed [15:0]   in_x_i,
  input  logic signed [15:0]   in_y_i,
  input  logic        [15:0]   in_load_i,
  input  logic                 in_pressed_i,

  output logic                 out_valid_o,
  input  logic                 out_ready_i,
  output logic                 out_slip_o,
  output logic                 out_raised_o,
  output logic                 out_over_o,
  output logic                 out_pressed_o,     // this sample's
  output logic signed [16:0]   out_dx_o,          // over the lag, 0 unless both samples are valid
  output logic signed [16:0]   out_dy_o,
  output logic        [2:0]    out_octant_o
);

  if (Lag < 1 || Lag > 4096) begin : gen_check_lag
    $fatal(1, "msn_cop_slip: Lag = %0d samples must lie in 1 .. 4096", Lag);
  end
  if (TimerBits < 1 || TimerBits > 31) begin : gen_check_timer_bits
    $fatal(1, "msn_cop_slip: TimerBits = %0d must lie in 1 .. 31", TimerBits);
  end

  // All stages advance together. `full`: Lag samples have come, so the delay line's output is valid.
  logic accept, full;
  assign in_ready_o = out_ready_i || !out_valid_o;
  assign accept     = in_valid_i && in_ready_o;

  logic signed [15:0] old_x, old_y;
  logic        [15:0] old_load;
  logic               old_pressed;
  msn_delay #(.Depth(Lag), .Width(49)) u_lag (
    .clk_i, .rst_i,
    .step_i(accept), .in_data_i({in_x_i, in_y_i, in_load_i, in_pressed_i}),
    .out_data_o({old_x, old_y, old_load, old_pressed})
  );

  localparam int unsigned CountBits = $clog2(Lag + 1);
  logic [CountBits-1:0] count;
  assign full = count == CountBits'(Lag);
  always_ff @(posedge clk_i) begin
    if (accept && !full) count <= count + 1'b1;
    if (rst_i) count <= '0;
  end

  // 1: the pair. 2: magnitudes, the drop. 3: the move. 4: the octant.
  logic               pair, seen_valid, seen_pair, size_valid, size_pair, size_drops;
  logic               scaled_valid, scaled_over, move_valid, move_over;
  logic signed [16:0] dx, dy, seen_dx, seen_dy, seen_fall, size_dx, size_dy, scaled_dx, scaled_dy;
  logic signed [16:0] move_dx, move_dy;
  logic        [23:0] seen_share;
  logic        [16:0] width, height, scaled_width, scaled_height;
  logic        [2:0]  octant, move_octant;
  logic               drops, moves;
  assign pair = full && in_pressed_i && old_pressed && old_load >= cfg_min_load_i;
  assign dx   = 17'(in_x_i) - 17'(old_x);
  assign dy   = 17'(in_y_i) - 17'(old_y);

  msn_compare #(.Width(26)) u_drops (
    .a_i({seen_fall[16], seen_fall, 8'b0}), .b_i({2'b0, seen_share}), .greater_o(drops)
  );

  logic [22:0] width_53, height_53, scaled_width_53, scaled_height_53;
  logic        flat, upright;
  msn_constant_multiplier #(.Constant(53), .InBits(17)) u_width (.in_data_i(width), .out_data_o(width_53));
  msn_constant_multiplier #(.Constant(53), .InBits(17)) u_height (.in_data_i(height), .out_data_o(height_53));
  assign flat    = {scaled_height, 7'b0} <= 24'(scaled_width_53);
  assign upright = {scaled_width, 7'b0} <= 24'(scaled_height_53);
  assign moves   = width >= 17'(cfg_move_i) || height >= 17'(cfg_move_i);

  always_comb begin
    if (flat) octant = scaled_dx[16] ? 3'd4 : 3'd0;
    else if (upright) octant = scaled_dy[16] ? 3'd6 : 3'd2;
    else if (scaled_dy[16]) octant = scaled_dx[16] ? 3'd5 : 3'd7;
    else octant = scaled_dx[16] ? 3'd3 : 3'd1;
  end

  logic [4:1] pressed;  // [k]: after clock k
  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      pressed     <= {pressed[3:1], in_pressed_i};
      seen_valid  <= in_valid_i;
      seen_pair   <= pair;
      seen_dx     <= pair ? dx : '0;
      seen_dy     <= pair ? dy : '0;
      seen_fall   <= signed'(17'(old_load) - 17'(in_load_i));
      seen_share  <= cfg_drop_i * old_load;

      size_valid  <= seen_valid;
      size_pair   <= seen_pair;
      size_drops  <= drops;
      size_dx     <= seen_dx;
      size_dy     <= seen_dy;
      width       <= seen_dx[16] ? '0 - seen_dx : seen_dx;
      height      <= seen_dy[16] ? '0 - seen_dy : seen_dy;

      scaled_valid     <= size_valid;
      scaled_over      <= size_pair && size_drops && moves;
      scaled_dx        <= size_dx;
      scaled_dy        <= size_dy;
      scaled_width     <= width;
      scaled_height    <= height;
      scaled_width_53  <= width_53;
      scaled_height_53 <= height_53;

      move_valid  <= scaled_valid;
      move_over   <= scaled_over;
      move_dx     <= scaled_dx;
      move_dy     <= scaled_dy;
      move_octant <= octant;
    end
    if (rst_i) begin
      seen_valid   <= 1'b0;
      size_valid   <= 1'b0;
      scaled_valid <= 1'b0;
      move_valid   <= 1'b0;
    end
  end

  // 5: the state. Both timers count up from minus the register's value, so that "still running" is the sign bit.
  logic [TimerBits:0] hold, refractory, load_hold, load_refractory;
  logic               slipping, next_slipping;
  always_ff @(posedge clk_i) begin
    load_hold       <= '0 - (TimerBits + 1)'(cfg_hold_i);
    load_refractory <= '0 - (TimerBits + 1)'(cfg_refractory_i);
  end
  assign next_slipping = slipping ? move_over || hold[TimerBits] : move_over && !refractory[TimerBits];

  always_ff @(posedge clk_i) begin
    if (in_ready_o && move_valid) begin
      slipping <= next_slipping;
      if (next_slipping) hold <= move_over ? load_hold : hold + 1'b1;
      if (slipping) refractory <= load_refractory;
      else if (refractory[TimerBits]) refractory <= refractory + 1'b1;
    end
    if (in_ready_o) begin
      out_valid_o   <= move_valid;
      out_slip_o    <= next_slipping;
      out_raised_o  <= next_slipping && !slipping;
      out_over_o    <= move_over;
      out_pressed_o <= pressed[4];
      out_dx_o      <= move_dx;
      out_dy_o      <= move_dy;
      out_octant_o  <= move_octant;
    end
    if (rst_i) begin
      out_valid_o <= 1'b0;
      slipping    <= 1'b0;
      refractory  <= '0;
    end
  end

endmodule
