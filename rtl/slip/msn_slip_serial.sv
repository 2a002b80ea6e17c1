// SPDX-License-Identifier: Apache-2.0
//
// The whole slip path of one channel, a digit a clock: msn_frame_filter, msn_haar, msn_peak_to_peak with tumbling
// windows and msn_slip, the same decisions bit for bit, for the smallest builds. Two passes over a sample's digits of
// one bit or two, lowest first; digit i of every variable is a column of word i of a small memory.
//   pass 1   d = even - odd, a = even + odd; compare d with the window's extremes, a with the levels; the timer
//   pass 2   new extremes, p2p = max d - min d; compare p2p with the thresholds; keep the sample
//   then     step the state, take the sample
// A sample is taken (in_ready_o) 2*Steps + 1 clocks after it is first offered, with actuator_moving_i of that
// clock; the decision follows one clock later. Steps: the power of two of digits that holds p2p with a digit to spare
// and a timer's sign. Model: model/meissner/twins/slip/slip_serial.py
// Error: none.

module msn_slip_serial #(
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Level      = 1,
  parameter  int unsigned Window     = 64,  // samples
  parameter  int unsigned TimerBits  = 14,
  parameter  int unsigned Digit      = 2,   // bits
  localparam int unsigned DetailBits = SampleBits + Level
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic        [DetailBits-1:0] cfg_threshold_i,
  input  logic        [DetailBits-1:0] cfg_gross_threshold_i,
  input  logic signed [DetailBits-1:0] cfg_contact_level_i,
  input  logic signed [DetailBits-1:0] cfg_release_level_i,
  input  logic                         cfg_contact_rises_i,  // pressing raises the level
  input  logic        [TimerBits-1:0]  cfg_hold_i,
  input  logic        [TimerBits-1:0]  cfg_refractory_i,
  input  logic        [TimerBits-1:0]  cfg_blank_i,
  input  logic        [DetailBits-1:0] cfg_keep_threshold_i,  // as the threshold or above it: no hysteresis
  input  logic                         actuator_moving_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic                         in_id_i,
  input  logic                         in_last_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output msn_pkg::slip_state_e         out_state_o,
  output logic                         out_raised_o,
  output logic                         out_over_o,
  output logic        [DetailBits-1:0] out_p2p_o,
  output logic                         out_end_o,

  output logic                         busy_o,       // a sample is under way, or a decision offered
  output logic        [31:0]           damaged_o,    // samples without `last`, and what follows them
  output logic        [31:0]           blanked_o     // details that were over while blanked or moving
);

  localparam int unsigned Bits      = (DetailBits + Digit > TimerBits) ? DetailBits + Digit : TimerBits + 1;
  localparam int unsigned StepBits  = $clog2((Bits + Digit - 1) / Digit);
  localparam int unsigned Steps     = 1 << StepBits;
  localparam int unsigned Width     = Steps * Digit;
  localparam int unsigned PlaceBits = $clog2(Window >> Level);

  if (SampleBits < 2) begin : gen_check_sample_bits
    $fatal(1, "msn_slip_serial: SampleBits = %0d must be at least 2", SampleBits);
  end
  if (Level < 1 || Level > 3) begin : gen_check_level
    $fatal(1, "msn_slip_serial: Level = %0d must be 1, 2 or 3", Level);
  end
  if (Window < (2 << Level) || !msn_pkg::is_power(Window)) begin : gen_check_window
    $fatal(1, "msn_slip_serial: Window = %0d must be a power of two, %0d or more", Window, 2 << Level);
  end
  if (TimerBits < 1 || TimerBits > 31) begin : gen_check_timer_bits
    $fatal(1, "msn_slip_serial: TimerBits = %0d must lie in 1 .. 31", TimerBits);
  end
  if (Digit != 1 && Digit != 2) begin : gen_check_digit
    $fatal(1, "msn_slip_serial: Digit = %0d must be 1 or 2", Digit);
  end

  // A sample without `last` or of another channel is taken at once, and so is all up to the next `last`.
  logic dropping, keep, forget;
  assign keep   = in_last_i && !in_id_i && !dropping;
  assign forget = in_valid_i && in_ready_o && !keep;

  // The address that is read runs a clock ahead of the digit that is worked on; the top bit of both: pass 2.
  logic [StepBits:0]   ahead, at;
  logic [StepBits-1:0] next_digit;
  logic                idle, start, finish, second, top;
  assign next_digit = ahead[StepBits-1:0];
  assign second     = at[StepBits];
  assign top        = &at[StepBits-1:0];
  assign start      = in_valid_i && keep && idle && !out_valid_o;
  assign in_ready_o = finish || (idle && !out_valid_o && !keep);
  assign busy_o     = !idle || out_valid_o;

  always_ff @(posedge clk_i) begin
    at     <= ahead;
    ahead  <= (finish || (idle && !start)) ? '0 : ahead + 1'b1;
    finish <= top && second && !idle;
    idle   <= finish || (idle && !start) || rst_i;
    if (in_valid_i && in_ready_o) dropping <= !in_last_i && !keep;
    if (rst_i) {at, ahead, finish, dropping} <= '0;
  end

  // Which sample of its group this is, and which detail of its window.
  logic [Level-1:0]     member;
  logic [PlaceBits-1:0] place;
  logic                 complete, decide, first;
  assign complete = &member;
  assign decide   = finish && complete;
  always_ff @(posedge clk_i) begin
    member <= member + Level'(finish);
    if (decide) {first, place} <= {1'b0, place} + 1'b1;
    if (forget || rst_i) begin
      {member, place} <= '0;
      first           <= 1'b1;
    end
  end

  function automatic logic [Digit-1:0] digit(logic [Steps-1:0][Digit-1:0] word, logic [StepBits-1:0] which);
    digit = word[which];
  endfunction

  // Is a number greater than another, from the lowest bit on: where two bits differ they decide. So are borrows.
  // Not "if they differ": that becomes a clock enable, and a second table for each.
  function automatic logic greater(logic [Digit-1:0] a, logic [Digit-1:0] b, logic so_far);
    greater = so_far;
    for (int k = 0; k < Digit; k++) greater = (a[k] && !b[k]) || (greater && (a[k] || !b[k]));
  endfunction

  // A digit of a - b; so is that of a + b, as a - ~b - 1.
  function automatic logic [Digit-1:0] rest(logic [Digit-1:0] a, logic [Digit-1:0] b, logic borrow);
    logic below;
    below = borrow;
    for (int k = 0; k < Digit; k++) begin
      rest[k] = a[k] ^ b[k] ^ below;
      below   = (b[k] && !a[k]) || (below && (b[k] || !a[k]));
    end
  endfunction

  // The inputs, digit by digit. One comparison serves two: for pressing without a contact, for lifting with one.
  msn_pkg::slip_state_e next_state;
  logic                 was_slipping, touching;
  assign was_slipping = out_state_o == msn_pkg::Incipient || out_state_o == msn_pkg::Gross;
  assign touching     = out_state_o == msn_pkg::Contact || was_slipping;

  logic [Digit-1:0] sample, limit, threshold, gross_threshold, keep_threshold;
  always_ff @(posedge clk_i) begin
    sample          <= digit(Width'(in_data_i), next_digit);
    limit           <= touching ? digit(Width'(cfg_release_level_i), next_digit)
                       : digit(Width'(cfg_contact_level_i), next_digit);
    threshold       <= digit(Width'(cfg_threshold_i), at[StepBits-1:0]);  // for the clock after
    gross_threshold <= digit(Width'(cfg_gross_threshold_i), at[StepBits-1:0]);
    keep_threshold  <= digit(Width'(cfg_keep_threshold_i), at[StepBits-1:0]);
  end

  // The Haar levels. A level keeps its value for the next one whenever all levels below it have one.
  logic restart;
  assign restart = idle || top;
  for (genvar l = 0; l < Level; l++) begin : gen_level
    localparam logic [Level-1:0] Below = Level'((1 << l) - 1);
    logic [Digit-1:0] now, kept, sum;
    logic             carry, keeps;
    if (l == 0) begin : gen_sample
      assign now = sample;
    end else begin : gen_total
      assign now = gen_level[l-1].sum;
    end
    assign keeps = second && (member & Below) == Below;
    assign sum   = rest(kept, ~now, !carry);
    (* no_rw_check, ram_style = "block" *) logic [Digit-1:0] memory [Steps];
    always_ff @(posedge clk_i) begin
      kept  <= memory[next_digit];
      carry <= !restart && greater(now, ~kept, carry);
      if (keeps) memory[at[StepBits-1:0]] <= now;
    end
  end
  logic [Digit-1:0] even, odd, total, detail;
  logic             detail_borrow;
  assign even   = gen_level[Level-1].kept;
  assign odd    = gen_level[Level-1].now;
  assign total  = gen_level[Level-1].sum;
  assign detail = rest(even, odd, detail_borrow);
  always_ff @(posedge clk_i) detail_borrow <= !restart && greater(odd, even, detail_borrow);

  // In two memories: for a write enable of each bit Yosys would pack words into a row and select with tables.
  logic [Digit-1:0] high, low, new_high, new_low, count, next_count;
  (* no_rw_check, ram_style = "block" *) logic [2*Digit-1:0] extremes_memory [Steps];
  (* no_rw_check, ram_style = "block" *) logic [Digit-1:0] timer_memory [Steps];
  always_ff @(posedge clk_i) begin
    {high, low} <= extremes_memory[next_digit];
    count       <= timer_memory[next_digit];
    if (second && complete) extremes_memory[at[StepBits-1:0]] <= {new_high, new_low};
    if (!idle && !finish && !second && complete) timer_memory[at[StepBits-1:0]] <= next_count;
  end

  // Pass 1: comparisons of signed numbers, so at the sign the other way round.
  logic             higher, lower, beyond;
  logic [Digit-1:0] sign, more, less;
  assign sign = Digit'(top) << (Digit - 1);
  assign {more, less} = cfg_contact_rises_i ? {limit, total} : {total, limit};
  always_ff @(posedge clk_i) begin
    if (!second) begin
      higher <= greater(detail ^ sign, high ^ sign, higher);
      lower  <= greater(low ^ sign, detail ^ sign, lower);
      beyond <= greater(more ^ sign, less ^ sign, beyond);
    end
    if (idle) {higher, lower, beyond} <= '0;
  end

  // Pass 2: the window's extremes, their difference, the thresholds. To shorten the critical path, a digit of p2p is
  // compared a clock late, at the top of p2p_q: first the last one of the pass before, which is 0 and changes nothing.
  logic             p2p_borrow, over, gross, above_keep;
  logic [Digit-1:0] p2p, compared;
  logic [Width-1:0] p2p_q;
  assign new_high  = (first || higher) ? detail : high;
  assign new_low   = (first || lower) ? detail : low;
  assign p2p       = rest(new_high, new_low, p2p_borrow);
  assign out_p2p_o = p2p_q[DetailBits-1:0];
  assign compared  = p2p_q[Width-1-:Digit];
  always_ff @(posedge clk_i) begin
    p2p_borrow <= !restart && greater(new_low, new_high, p2p_borrow);
    over       <= greater(compared, threshold, over);
    gross      <= greater(compared, gross_threshold, gross);
    above_keep <= greater(compared, keep_threshold, above_keep);
    if (!second) {over, gross, above_keep} <= '0;
    if (second) p2p_q <= {p2p, p2p_q[Width-1:Digit]};
  end

  // The timer counts up from minus a register's value and runs while its sign is set (not a bit above, which may be
  // upset). It is loaded, or counts 1, in pass 1: hold in slips and Release, blank or refractory in Contact.
  logic             running, tick_carry, load, next_load, blanking, next_blanking;
  logic [Digit-1:0] load_digit;
  assign next_count = load ? load_digit : rest(count, '1, !tick_carry);
  always_ff @(posedge clk_i) begin
    load_digit <= (was_slipping || !touching) ? digit('0 - Width'(cfg_hold_i), next_digit)
                  : blanking ? digit('0 - Width'(cfg_blank_i), next_digit)
                  : digit('0 - Width'(cfg_refractory_i), next_digit);
    tick_carry <= idle ? running : (tick_carry && &count);
    if (complete && !idle && at == (StepBits+1)'(TimerBits / Digit)) running <= next_count[TimerBits%Digit];
  end

  // The state, as in msn_slip.
  logic counts, slipping, acts, renews;
  assign acts   = over && !actuator_moving_i;
  assign renews = (over || above_keep) && !actuator_moving_i;
  always_comb begin
    next_state    = out_state_o;
    next_load     = beyond || !running;
    next_blanking = !was_slipping;
    counts        = 1'b0;
    if (touching && beyond) begin
      next_state = msn_pkg::Release;
    end else if (was_slipping) begin
      counts    = over && actuator_moving_i;
      next_load = renews || !running;
      if (acts && gross) next_state = msn_pkg::Gross;
      if (!renews && !running) next_state = msn_pkg::Contact;
    end else if (touching) begin
      counts        = over && (actuator_moving_i || (blanking && running));
      next_load     = acts && !running;
      next_blanking = blanking;
      if (next_load) next_state = gross ? msn_pkg::Gross : msn_pkg::Incipient;
    end else begin
      next_load = !beyond || !running;
      if (!beyond) next_state = msn_pkg::Contact;
      else if (out_state_o == msn_pkg::None || !running) next_state = msn_pkg::None;
    end
  end
  assign slipping = next_state == msn_pkg::Incipient || next_state == msn_pkg::Gross;

  always_ff @(posedge clk_i) begin
    out_valid_o <= decide || (out_valid_o && !out_ready_i);
    if (decide) begin
      out_state_o  <= next_state;
      out_raised_o <= slipping && !was_slipping;
      out_over_o   <= over;
      out_end_o    <= &place;
      {load, blanking} <= {next_load, next_blanking};
      if (counts) blanked_o <= blanked_o + 1'b1;
    end
    if (forget) out_state_o <= msn_pkg::None;
    if (forget && in_last_i) damaged_o <= damaged_o + 1'b1;
    if (rst_i) begin
      {out_valid_o, damaged_o, blanked_o} <= '0;
      out_state_o <= msn_pkg::None;
    end
  end

  // The memories do not define what they answer while the same word is written.
  msn_check u_read_is_not_written (
    .clk_i, .rst_i, .wrong_i(!rst_i && !idle && !finish && at[StepBits-1:0] == next_digit)
  );

endmodule
