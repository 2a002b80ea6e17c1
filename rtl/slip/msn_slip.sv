// SPDX-License-Identifier: Apache-2.0
//
// What the contact on each of the interleaved channels is doing, one step per detail.
//
//   pressed = level >= contact_level   lifted = level < release_level     (contact_rises)
//   pressed = level <= contact_level   lifted = level > release_level     (otherwise)
//   over = p2p > threshold             gross = p2p > gross_threshold     kept = over or p2p > keep_threshold
//
// None, Release -> Contact when pressed; Contact -> Incipient (Gross) when over, unless blanked (the
// first `blank` details of a contact), moving, or refractory; back to Contact after `hold` details that
// were not kept, then no slip for `refractory` details; any contact -> Release when lifted, then None after
// `hold` details. `raised` marks the detail at which the slip flag rises. All times are in details. Mask: a masked
// detail leads to None from any state and is never over.
//
//   clock  1        2
//          compare  step the state; a delay line returns each channel's own state
//
// Latency 2 clocks, one detail per clock.   Model: model/meissner/twins/slip/slip.py
// Error: none.

module msn_slip #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned DetailBits = 18,
  parameter  int unsigned TimerBits  = 16,
  parameter  bit          Mask       = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
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
  input  logic        [DetailBits-1:0] cfg_keep_threshold_i,  // at the threshold or above it: no hysteresis
  input  logic                         actuator_moving_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic        [DetailBits-1:0] in_p2p_i,
  input  logic signed [DetailBits-1:0] in_total_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         in_last_i,
  input  logic                         in_restart_i,
  input  logic                         in_mask_i,
  input  logic                         in_end_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output msn_pkg::slip_state_e         out_state_o,
  output logic                         out_raised_o,
  output logic                         out_over_o,
  output logic        [DetailBits-1:0] out_p2p_o,
  output logic        [IdBits-1:0]     out_id_o,
  output logic                         out_last_o,
  output logic                         out_end_o,

  output logic                         busy_o,        // a detail is under way, or a decision offered
  output logic        [31:0]           blanked_o     // details that were over while blanked or moving
);

  if (Channels < 1 || Channels > 4096) begin : gen_check_channels
    $fatal(1, "msn_slip: Channels = %0d must lie in 1 .. 4096", Channels);
  end
  if (TimerBits < 1 || TimerBits > 31) begin : gen_check_timer_bits
    $fatal(1, "msn_slip: TimerBits = %0d must lie in 1 .. 31", TimerBits);
  end

  // 1: compare. Both stages advance together.
  logic under_contact, over_contact, under_release, over_release, is_over, is_gross, is_kept;
  msn_compare #(.Width(DetailBits)) u_under_contact (
    .a_i(cfg_contact_level_i), .b_i(in_total_i), .greater_o(under_contact)
  );
  msn_compare #(.Width(DetailBits)) u_over_contact (
    .a_i(in_total_i), .b_i(cfg_contact_level_i), .greater_o(over_contact)
  );
  msn_compare #(.Width(DetailBits)) u_under_release (
    .a_i(cfg_release_level_i), .b_i(in_total_i), .greater_o(under_release)
  );
  msn_compare #(.Width(DetailBits)) u_over_release (
    .a_i(in_total_i), .b_i(cfg_release_level_i), .greater_o(over_release)
  );
  msn_compare #(.Width(DetailBits + 1)) u_over (
    .a_i({1'b0, in_p2p_i}), .b_i({1'b0, cfg_threshold_i}), .greater_o(is_over)
  );
  msn_compare #(.Width(DetailBits + 1)) u_gross (
    .a_i({1'b0, in_p2p_i}), .b_i({1'b0, cfg_gross_threshold_i}), .greater_o(is_gross)
  );
  msn_compare #(.Width(DetailBits + 1)) u_kept (
    .a_i({1'b0, in_p2p_i}), .b_i({1'b0, cfg_keep_threshold_i}), .greater_o(is_kept)
  );

  logic                  seen_valid, pressed, lifted, over, gross, kept, moving, restart, masked;
  logic [DetailBits-1:0] seen_p2p;
  logic [IdBits-1:0]     seen_id;
  logic                  seen_last, seen_end;
  assign in_ready_o = out_ready_i || !out_valid_o;
  assign busy_o     = seen_valid || out_valid_o;
  assign masked     = Mask && in_mask_i;  // restarts from None, and changes nothing else

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      seen_valid <= in_valid_i;
      pressed    <= (cfg_contact_rises_i ? !under_contact : !over_contact) && !masked;
      lifted     <= cfg_contact_rises_i ? under_release : over_release;
      over       <= is_over && !masked;
      gross      <= is_gross;
      kept       <= (is_over || is_kept) && !masked;
      moving     <= actuator_moving_i;
      restart    <= in_restart_i || masked;
      seen_p2p   <= in_p2p_i;
      seen_id    <= in_id_i;
      seen_last  <= in_last_i;
      seen_end   <= in_end_i;
    end
    if (rst_i) seen_valid <= 1'b0;
  end

  // 2: step the state. The timer counts the details until a slip or a release ends (hold), or in Contact until
  // a slip may be raised (refractory, or blanking after a contact onset): a state needs only one of these times.
  // It counts up from minus the register's value, so that "still running" is the sign bit, without a comparator.
  localparam int unsigned CountBits = TimerBits + 1;
  logic [CountBits-1:0] load_hold, load_refractory, load_blank;
  always_ff @(posedge clk_i) begin
    load_hold       <= '0 - CountBits'(cfg_hold_i);
    load_refractory <= '0 - CountBits'(cfg_refractory_i);
    load_blank      <= '0 - CountBits'(cfg_blank_i);
  end

  msn_pkg::slip_state_e kept_state, state, next_state;
  logic                 blanking, next_blanking, step, running, blank_this, blanked;
  logic [CountBits-1:0] timer, next_timer;
  assign step = seen_valid && in_ready_o;

  msn_delay #(.Depth(Channels), .Width(4 + CountBits)) u_memory (
    .clk_i, .rst_i,
    .step_i(step), .in_data_i({next_state, next_blanking, next_timer}),
    .out_data_o({kept_state, blanking, timer})
  );
  assign state   = restart ? msn_pkg::None : kept_state;  // the timer is not used in None
  assign running = timer[TimerBits];

  logic touching, was_slipping, acts;
  assign touching     = state == msn_pkg::Contact || was_slipping;
  assign was_slipping = state == msn_pkg::Incipient || state == msn_pkg::Gross;
  assign acts         = over && !moving;

  always_comb begin
    next_state    = state;
    next_blanking = blanking;
    next_timer    = running ? timer + 1'b1 : timer;
    blank_this    = 1'b0;
    if (touching && lifted) begin
      next_state = msn_pkg::Release;
      next_timer = load_hold;
    end else if (was_slipping) begin
      blank_this = over && moving;
      if (kept && !moving) begin
        next_timer = load_hold;
        if (acts && gross) next_state = msn_pkg::Gross;
      end else if (!running) begin
        next_state    = msn_pkg::Contact;
        next_timer    = load_refractory;
        next_blanking = 1'b0;
      end
    end else if (touching) begin
      blank_this = over && (moving || (blanking && running));
      if (acts && !running) begin
        next_state = gross ? msn_pkg::Gross : msn_pkg::Incipient;
        next_timer = load_hold;
      end
    end else if (pressed) begin
      next_state    = msn_pkg::Contact;
      next_timer    = load_blank;
      next_blanking = 1'b1;
    end else if (!(state == msn_pkg::Release && running)) begin
      next_state = msn_pkg::None;
    end
  end

  logic slipping;
  assign slipping = next_state == msn_pkg::Incipient || next_state == msn_pkg::Gross;

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      out_valid_o  <= seen_valid;
      out_state_o  <= next_state;
      out_raised_o <= slipping && !was_slipping;
      out_over_o   <= over;
      out_p2p_o    <= seen_p2p;
      out_id_o     <= seen_id;
      out_last_o   <= seen_last;
      out_end_o    <= seen_end;
    end
    blanked <= step && blank_this;
    if (blanked) blanked_o <= blanked_o + 1'b1;  // a clock later: 32 clock enables are slow
    if (rst_i) begin
      out_valid_o <= 1'b0;
      blanked     <= 1'b0;
      blanked_o   <= '0;
    end
  end

endmodule
