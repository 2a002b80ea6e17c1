// SPDX-License-Identifier: Apache-2.0
//
// Amplitude of a carrier with N = SamplesPerPeriod samples a period, over `periods` full periods for each taxel.
//
//   rectifier    M = sum |x[n] - x[n + N/2]| over the first half of each period
//   synchronous  I + jQ = sum (c + js)[n] x[n],   M = sqrt(I^2 + Q^2), exact or estimated
//   out = M / 2^cfg_shift, rounded half up, once; at most 2^(SampleBits-1) - 1
//
// (c, s): (1,0) for N = 4; (5,2) (2,5) for 8; (5,1) (4,3) (3,4) (1,5) for 16; then turned by 90 degrees. Weights
// half a period apart cancel, which removes a constant offset exactly in every form; a quarter turn swaps c and
// s, so M of the synchronous forms does not depend on the phase. Each start begins a measurement: `skip` samples
// are ignored to settle, then the measured samples follow; later ones are ignored.
//
//   clock  1              2        3     4 ..       then cfg_shift + 1  1
//          weigh, compare I, Q, M  held  magnitude  shift               round
// The first lane leaves after model.latency() clocks, the others model.lane_clocks() apart; samples wait only
// when a measurement ends before the previous lanes are out.   Model: model/meissner/twins/frontend/am_demod.py
// Error: at most 1/2 LSB (tb/extremes).

module msn_am_demod #(
  parameter  int unsigned Form             = msn_pkg::DemodIq,  // msn_pkg::demod_form_e
  parameter  int unsigned SamplesPerPeriod = 4,
  parameter  int unsigned Lanes            = 1,   // taxels measured at once; lane k has id in_id_i + k
  parameter  int unsigned Channels         = 64,
  parameter  int unsigned SampleBits       = 17,
  parameter  int unsigned PeriodBits       = 6,   // of cfg_periods_i
  parameter  int unsigned SkipBits         = 8,
  localparam int unsigned IdBits           = msn_pkg::index_width(Channels)
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  // Settings, read with in_start_i.
  input  logic [PeriodBits-1:0]        cfg_periods_i,  // 0: 2^PeriodBits
  input  logic [SkipBits-1:0]          cfg_skip_i,     // samples
  input  logic [4:0]                   cfg_shift_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic [Lanes*SampleBits-1:0]  in_data_i,      // signed, lane 0 lowest
  input  logic [Lanes-1:0]             in_user_i,      // over-range
  input  logic                         in_start_i,     // first sample after a switch; id, last read with it
  input  logic [IdBits-1:0]            in_id_i,        // of lane 0
  input  logic                         in_last_i,      // the last lane ends the frame

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic signed [SampleBits-1:0] out_data_o,     // never negative
  output logic [IdBits-1:0]            out_id_o,
  output logic                         out_last_o,
  output logic                         out_user_o,     // the result or one of its samples is over-range

  output logic [31:0]                  broken_o        // measurements cut off by the next start, since reset
);

  localparam bit          Rectify   = Form == 32'(msn_pkg::DemodRectifier);
  localparam int unsigned N         = SamplesPerPeriod;
  localparam int unsigned PhaseBits = $clog2(N);
  // Growth over a period: rectifier N/2 pairs; synchronous 1, 14 and 26 pairs, for which 4 and 5 bits.
  localparam int unsigned GrowBits  = Rectify ? PhaseBits - 1 : (N == 4) ? 0 : (N == 8) ? 4 : 5;
  localparam int unsigned SumBits   = SampleBits + GrowBits + PeriodBits;  // of |I|, |Q|, M
  localparam int unsigned RootBits  = SumBits + 2;                         // of 2 M
  localparam int unsigned HeldBits  = 2 * (SumBits + 1) + 1;               // I, Q, over-range

  if (Form > 32'(msn_pkg::DemodIqFast)) begin : gen_check_form
    $fatal(1, "msn_am_demod: Form = %0d must be one of msn_pkg::demod_form_e", Form);
  end
  if (SamplesPerPeriod != 4 && SamplesPerPeriod != 8 && SamplesPerPeriod != 16) begin : gen_check_samples
    $fatal(1, "msn_am_demod: SamplesPerPeriod = %0d must be 4, 8 or 16", SamplesPerPeriod);
  end
  if (Lanes < 1 || Lanes > 8) begin : gen_check_lanes
    $fatal(1, "msn_am_demod: Lanes = %0d must lie in 1 .. 8", Lanes);
  end
  if (Channels < Lanes || Channels > 65536) begin : gen_check_channels
    $fatal(1, "msn_am_demod: Channels = %0d must lie in Lanes .. 65536", Channels);
  end
  if (SampleBits < 4 || SampleBits > 18) begin : gen_check_sample_bits
    $fatal(1, "msn_am_demod: SampleBits = %0d must lie in 4 .. 18", SampleBits);
  end
  if (PeriodBits < 1 || SumBits > 29) begin : gen_check_period_bits
    $fatal(1, "msn_am_demod: PeriodBits = %0d must be at least 1, and the sums at most 29 bits", PeriodBits);
  end
  if (SkipBits < 1 || SkipBits > 32) begin : gen_check_skip_bits
    $fatal(1, "msn_am_demod: SkipBits = %0d must lie in 1 .. 32", SkipBits);
  end

  // The position of a sample in its measurement.
  logic                  take, active, active_q, counts, fresh, fresh_q, ends, broken;
  logic [SkipBits-1:0]   skip, skip_q;
  logic [PhaseBits-1:0]  phase, phase_q;
  logic [PeriodBits-1:0] periods, periods_q;
  logic [IdBits-1:0]     id;
  logic                  last;
  logic [4:0]            shift;
  assign take    = in_valid_i && in_ready_o;
  assign active  = in_start_i || active_q;
  assign fresh   = in_start_i || fresh_q;
  assign skip    = in_start_i ? cfg_skip_i : skip_q;
  assign phase   = in_start_i ? '0 : phase_q;
  assign periods = in_start_i ? cfg_periods_i : periods_q;
  assign counts  = active && skip == '0;
  assign ends    = counts && (&phase) && periods == PeriodBits'(1);

  always_ff @(posedge clk_i) begin
    if (take) begin
      active_q  <= active && !ends;
      fresh_q   <= fresh && !counts;
      skip_q    <= (skip == '0) ? '0 : skip - 1'b1;
      phase_q   <= counts ? phase + 1'b1 : phase;
      periods_q <= (counts && (&phase)) ? periods - 1'b1 : periods;
    end
    if (take && in_start_i) begin
      id    <= in_id_i;
      last  <= in_last_i;
      shift <= cfg_shift_i;
    end
    broken <= take && in_start_i && active_q;
    if (broken) broken_o <= broken_o + 1'b1;
    if (rst_i) begin
      active_q <= 1'b0;
      broken   <= 1'b0;
      broken_o <= '0;
    end
  end

  // 1: weigh. All lanes advance together and stall only while a finished measurement waits for the lanes of the
  // previous one to be taken. A measurement has at least four samples, so its id is still held when it is done.
  logic              step, done, move, weighed, weighed_first, weighed_ends;
  logic              swap, mid, negative_i, negative_q, done_last;
  logic [IdBits-1:0] done_id;
  logic [4:0]        done_shift;
  logic [3:0]        lanes_left;  // lanes still held
  assign move       = done && lanes_left == '0;
  assign step       = !done || move;
  assign in_ready_o = step;

  always_ff @(posedge clk_i) begin
    if (step) begin
      weighed       <= in_valid_i && counts;
      weighed_first <= fresh;
      weighed_ends  <= ends;
      negative_i    <= phase[PhaseBits-1] ^ phase[PhaseBits-2];  // quarters 1 and 2: weights -s, -c
      negative_q    <= phase[PhaseBits-1];                       // quarters 2 and 3
      done          <= weighed && weighed_ends;
      done_id       <= id;
      done_last     <= last;
      done_shift    <= shift;
    end
    if (rst_i) begin
      weighed <= 1'b0;
      done    <= 1'b0;
    end
  end

  // Of c x and s x one is y = x, 3x or 5x, the other z = 0, x, 2x or 4x; swap: c x is z. A quarter turn swaps too.
  if (N == 4) begin : gen_weights_4
    assign {swap, mid} = {phase[0], 1'b0};
  end else begin : gen_weights
    assign swap = phase[PhaseBits-2] ^ phase[0];
    assign mid  = N == 16 && (phase[1] ^ phase[0]);
  end

  // 2: sum. -t is added as ~t + 1, with the 1 as an extra bit below, so that each sum is one carry chain.
  localparam int unsigned TermBits = SampleBits + 3;
  logic [Lanes*HeldBits-1:0] sums;
  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    logic signed [SampleBits-1:0] x;
    logic signed [TermBits-1:0]   y, z, term_i;
    logic        [SumBits:0]      sum_i, next_i;
    logic                         user, over, negative, unused_i;
    assign x = signed'(in_data_i[k*SampleBits+:SampleBits]);
    assign negative = Rectify ? term_i[TermBits-1] : negative_i;
    assign {next_i, unused_i} = {weighed_first ? '0 : sum_i, 1'b1}
                                + {(SumBits+1)'(term_i) ^ {(SumBits+1){negative}}, negative};

    if (Rectify) begin : gen_rectifier
      logic [SampleBits-1:0] x_before;  // N/2 samples ago
      msn_delay #(.Depth(N / 2), .Width(SampleBits)) u_half (
        .clk_i, .rst_i,
        .step_i(take), .in_data_i(in_data_i[k*SampleBits+:SampleBits]), .out_data_o(x_before)
      );
      assign y = phase[PhaseBits-1] ? TermBits'(x) - TermBits'(signed'(x_before)) : '0;
      assign z = '0;
      assign sums[k*HeldBits+:HeldBits] = {(SumBits + 1)'(0), sum_i, over};
    end else begin : gen_synchronous
      logic signed [TermBits-1:0] term_q;
      logic        [SumBits:0]    sum_q, next_q;
      logic                       unused_q;
      assign y = (N == 4) ? TermBits'(x) : TermBits'(x) + (TermBits'(x) <<< (mid ? 1 : 2));
      assign z = (N == 4) ? '0 : (N == 8) ? TermBits'(x) <<< 1 : mid ? TermBits'(x) <<< 2 : TermBits'(x);
      assign {next_q, unused_q} = {weighed_first ? '0 : sum_q, 1'b1}
                                  + {(SumBits+1)'(term_q) ^ {(SumBits+1){negative_q}}, negative_q};
      always_ff @(posedge clk_i) begin
        if (step) begin
          term_q <= swap ? y : z;
          if (weighed) sum_q <= next_q;
        end
      end
      assign sums[k*HeldBits+:HeldBits] = {sum_q, sum_i, over};
    end

    always_ff @(posedge clk_i) begin
      if (step) begin
        user   <= in_user_i[k];
        term_i <= (swap && !Rectify) ? z : y;
        if (weighed) begin
          sum_i <= next_i;
          over  <= (over && !weighed_first) || user;
        end
      end
    end
  end

  // 3: hold the lanes' sums and pass them on one by one.
  logic [Lanes*HeldBits-1:0] held;
  logic [IdBits-1:0]         held_id;
  logic                      held_last, pull;
  logic [4:0]                held_shift;
  always_ff @(posedge clk_i) begin
    if (pull) begin
      held       <= (Lanes > 1) ? held >> HeldBits : '0;
      held_id    <= held_id + 1'b1;
      lanes_left <= lanes_left - 1'b1;
    end
    if (move) begin
      held       <= sums;
      held_id    <= done_id;
      held_last  <= done_last;
      held_shift <= done_shift;
      lanes_left <= 4'(Lanes);
    end
    if (rst_i) lanes_left <= '0;
  end

  // 4: magnitude, times 2: the extra bit is for rounding.
  localparam int unsigned SideBits = 5 + IdBits + 2;
  logic                root_valid, root_ready;
  logic [RootBits-1:0] root;
  logic [SideBits-1:0] held_side, root_side;
  assign held_side = {held_shift, held_id, held_last && lanes_left == 4'd1, held[0]};
  if (Rectify) begin : gen_sum
    assign root_valid = lanes_left != '0;
    assign pull       = root_valid && root_ready;
    assign root       = {held[SumBits+1:1], 1'b0};
    assign root_side  = held_side;
  end else begin : gen_magnitude
    logic               hypot_ready;
    logic [SumBits:0]   sum_i, sum_q;
    logic [SumBits-1:0] size_i, size_q;
    assign {sum_q, sum_i} = held[HeldBits-1:1];
    assign size_i = sum_i[SumBits] ? -sum_i[SumBits-1:0] : sum_i[SumBits-1:0];
    assign size_q = sum_q[SumBits] ? -sum_q[SumBits-1:0] : sum_q[SumBits-1:0];
    assign pull   = hypot_ready && lanes_left != '0;
    always_ff @(posedge clk_i) if (pull) root_side <= held_side;
    msn_hypot #(.Bits(SumBits + 1), .Exact(Form == 32'(msn_pkg::DemodIq))) u_hypot (
      .clk_i, .rst_i,
      .in_valid_i(lanes_left != '0), .in_ready_o(hypot_ready), .in_a_i({size_i, 1'b0}),
      .in_b_i({size_q, 1'b0}),
      .out_valid_o(root_valid), .out_ready_i(root_ready), .out_root_o(root)
    );
  end

  // Shift by one bit a clock; round and saturate.
  logic                shifting, shifted, free, tail_last, tail_over, too_large;
  logic [RootBits-1:0] tail;
  logic [RootBits-1:0] rounded;
  logic [IdBits-1:0]   tail_id;
  logic [4:0]          tail_left;
  assign free       = out_ready_i || !out_valid_o;
  assign shifted    = tail_left == '0;
  assign root_ready = !shifting || (shifted && free);
  assign rounded    = (tail >> 1) + RootBits'(tail[0]);
  assign too_large  = |rounded[RootBits-1:SampleBits-1];

  always_ff @(posedge clk_i) begin
    if (!shifted) begin
      tail      <= tail >> 1;
      tail_left <= tail_left - 1'b1;
    end
    if (shifted && free) shifting <= 1'b0;
    if (root_valid && root_ready) begin
      shifting <= 1'b1;
      tail     <= root;
      {tail_left, tail_id, tail_last, tail_over} <= root_side;
    end
    if (free) begin
      out_valid_o <= shifting && shifted;
      out_data_o  <= too_large ? {1'b0, {(SampleBits - 1){1'b1}}} : {1'b0, rounded[SampleBits-2:0]};
      out_id_o    <= tail_id;
      out_last_o  <= tail_last;
      out_user_o  <= tail_over || too_large;
    end
    if (rst_i) begin
      shifting    <= 1'b0;
      tail_left   <= '0;
      out_valid_o <= 1'b0;
    end
  end

endmodule
