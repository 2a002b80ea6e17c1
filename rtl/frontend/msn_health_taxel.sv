// SPDX-License-Identifier: Apache-2.0
//
// Judges one taxel of a frame: its next state, its faults, whether it moved. msn_health describes the faults.
//
//   state: held sample, counters rail, blink, still, frames since a move (2 bits), its direction, a jump in the last
//   frame, the faults dead, railed, blinking, and whether they were reported
//
//   clock  1             2           3            4         5
//          take, sample  raw - held  moved, jump  counters  state
//
// The state and the neighbours' inputs are read with take_i, raw_i a clock later, tick_i, fresh_i and send_i in clock
// 4, in which the event outputs are valid. Counters saturate at 255. No reset: invalid results are not used.
// Error: none.
// Model: model/meissner/twins/frontend/health_taxel.py

module msn_health_taxel #(
  parameter  int unsigned SampleBits = 17,
  localparam int unsigned StateBits  = SampleBits + 32
) (
  input  logic                         clk_i,

  input  msn_registers_pkg::health_cfg_t cfg_i,

  input  logic                         take_i,
  input  logic [StateBits-1:0]         state_i,
  input  logic                         pair_i,     // both neighbours in a row or column moved the same way
  input  logic                         border_i,   // at a border: the one neighbour is recent
  input  logic                         alone_i,    // no neighbour is recent
  input  logic                         user_i,     // over-range
  input  logic                         surplus_i,  // a lane outside the array
  input  logic                         again_i,    // no fault counts as reported
  input  logic signed [SampleBits-1:0] raw_i,
  input  logic                         tick_i,     // the rail counter counts in this frame
  input  logic                         fresh_i,    // the first frame: there is no state yet

  output logic                         event_o,     // there are faults not all of which were reported
  output logic [2:0]                   faults_o,
  output logic [2:0]                   news_o,
  input  logic                         send_i,     // the faults are reported now
  output logic [StateBits-1:0]         state_o,
  output logic [1:0]                   moves_o     // {recent, upwards}
);

  localparam int unsigned DiffBits = SampleBits + 1;

  logic [SampleBits-1:0] band, jump_least;
  assign {band, jump_least} = {SampleBits'(cfg_i.band), SampleBits'(cfg_i.jump)};

  // Thresholds minus the increment of their counter, or negated.
  logic signed [9:0]          still_less_1, still_less_4, blink_edge;
  logic        [7:0]          rail_edge;
  logic signed [DiffBits-1:0] band_minus, jump_minus;
  always_ff @(posedge clk_i) begin
    still_less_1 <= signed'({2'b0, cfg_i.still}) - 10'sd1;
    still_less_4 <= signed'({2'b0, cfg_i.still}) - 10'sd4;
    blink_edge   <= signed'({2'b0, cfg_i.blink}) - 10'sd16;
    rail_edge    <= cfg_i.rail - 8'd1;
    band_minus   <= '0 - DiffBits'(band);
    jump_minus   <= '0 - DiffBits'(jump_least);
  end

  // 1, 2: compare the sample with the held one and with the rails.
  logic signed [SampleBits-1:0] held;
  logic        [28:0]           kept_1, kept_2, kept_3;
  logic        [2:0]            fault_1, fault_2, fault_3;
  logic                         surplus_1, surplus_2, surplus_3, user_1, pair_1, border_1, low, high;
  logic signed [DiffBits-1:0]   delta;
  logic        [SampleBits-1:0] raw_2, raw_3, held_2, held_3;
  logic                         over_2, over_3, alone_1, alone_2, alone_3;
  logic        [2:0]            proof_2, proof_3;
  msn_compare #(.Width(SampleBits)) u_low (
    .a_i(raw_i), .b_i(SampleBits'(signed'(cfg_i.low))), .greater_o(low)
  );
  msn_compare #(.Width(SampleBits)) u_high (
    .a_i(SampleBits'(signed'(cfg_i.high))), .b_i(raw_i), .greater_o(high)
  );

  // 3: does the difference exceed the band, the jump?
  logic above, below, far_above, far_below, moved, jump, rises;
  msn_compare #(.Width(DiffBits)) u_above (
    .a_i(delta), .b_i(signed'({1'b0, band})), .greater_o(above)
  );
  msn_compare #(.Width(DiffBits)) u_below (.a_i(band_minus), .b_i(delta), .greater_o(below));
  msn_compare #(.Width(DiffBits)) u_far_above (
    .a_i(delta), .b_i(signed'({1'b0, jump_least})), .greater_o(far_above)
  );
  msn_compare #(.Width(DiffBits)) u_far_below (.a_i(jump_minus), .b_i(delta), .greater_o(far_below));

  // 4: the next state.
  logic [7:0] rail, blink, still, rail_next, blink_next, still_next, rail_more;
  logic [8:0] blink_more, still_more;
  logic       more_blinks, up_last, jumped, up_next, reported;
  logic [1:0] since, since_next;
  logic [2:0] found, faults_next;
  assign {rail, blink, still, since, up_last, jumped, reported} = kept_3;
  assign rail_more   = rail + 8'(tick_i && rail != '1);
  assign rail_next   = !over_3 ? '0 : rail_more;
  assign blink_more  = {1'b0, blink} + 9'd16;
  assign more_blinks = jumped && alone_3;
  assign blink_next  = more_blinks ? blink_more[7:0] | {8{blink_more[8]}} : blink - 8'(blink != '0);
  assign still_more  = {1'b0, still} + 9'(proof_3);
  assign still_next  = moved || since != '0 ? '0 : still_more[7:0] | {8{still_more[8]}};
  assign since_next  = moved ? 2'd3 : since - 2'(since != '0);
  assign up_next     = moved ? rises : up_last;
  // Do still_next, rail_next, blink_next reach their thresholds? The increments are subtracted from the thresholds.
  logic signed [9:0] still_edge;
  assign still_edge = proof_3[2] ? still_less_4 : proof_3[0] ? still_less_1 : signed'({2'b0, cfg_i.still});
  assign found      = {signed'({2'b0, still}) >= still_edge && !moved && since == '0 && cfg_i.still != '0,
                       (rail >= cfg_i.rail || (tick_i && rail == rail_edge)) && over_3 && cfg_i.rail != '0,
                       (more_blinks ? signed'({2'b0, blink}) >= blink_edge : blink > cfg_i.blink)
                       && cfg_i.blink != '0};
  assign faults_next = surplus_3 || fresh_i ? '0 : fault_3 | found;

  logic [StateBits-1:4] state_4;
  logic [1:0]           moves_4;
  logic                 known_4, reported_4;
  assign reported_4 = known_4 && news_o == '0;  // valid only where there are faults
  assign event_o     = |faults_o && !reported_4;

  always_ff @(posedge clk_i) begin
    if (take_i) begin
      held      <= signed'(state_i[StateBits-1-:SampleBits]);
      kept_1    <= {state_i[31:4], state_i[0] && !again_i};
      fault_1   <= state_i[3:1];
      surplus_1 <= surplus_i;
      user_1    <= user_i;
      pair_1    <= pair_i;
      border_1  <= border_i;
      alone_1   <= alone_i;
    end

    delta   <= DiffBits'(raw_i) - DiffBits'(held);
    raw_2   <= raw_i;
    held_2  <= held;
    over_2  <= !low || !high || (user_1 && cfg_i.use_user);
    alone_2 <= alone_1;
    proof_2 <= pair_1 ? 3'd4 : 3'(border_1);
    {kept_2, fault_2, surplus_2} <= {kept_1, fault_1, surplus_1};

    moved   <= above || below;
    jump    <= far_above || far_below;
    rises   <= !delta[DiffBits-1];
    raw_3   <= raw_2;
    held_3  <= held_2;
    over_3  <= over_2;
    alone_3 <= alone_2;
    proof_3 <= proof_2;
    {kept_3, fault_3, surplus_3} <= {kept_2, fault_2, surplus_2};

    faults_o <= faults_next;
    news_o   <= faults_next & ~fault_3;
    known_4  <= reported;
    moves_4  <= {since_next != '0 && !fresh_i, up_next};
    state_4  <= fresh_i ? {raw_3, 28'd0} :
                {moved ? raw_3 : held_3, rail_next, blink_next, still_next, since_next, up_next, jump};

    state_o <= {state_4, faults_o, |faults_o && (reported_4 || send_i)};
    moves_o <= moves_4;
  end

  logic unused_cfg;  // msn_health uses the other settings
  assign unused_cfg = ^cfg_i;

endmodule
