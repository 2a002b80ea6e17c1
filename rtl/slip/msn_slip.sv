// SPDX-License-Identifier: Apache-2.0
//
// What the contact on each of the interleaved channels is doing, one step per detail.
//
//   pressed = level >= contact_level   lifted = level < release_level     (contact_rises)
//   pressed = level <= contact_level   lifted = level > release_level     (otherwise)
//   over = p2p > threshold             gross = p2p > gross_threshold
//
// None, Release -> Contact when pressed; Contact -> Incipient (Gross) when over, unless blanked (the
// first `blank` details of a contact), moving, or refractory; back to Contact after `hold` details that
// were not over, then deaf for `refractory` details; any contact -> Release when lifted, then None after
// `hold` details. `raised` marks the detail at which the slip flag rises. All times count details.
//
//   clock  1        2
//          compare  step the state, whose delay line hands each channel its own
//
// Latency 2 clocks, one detail per clock.   Model: model/meissner/slip/slip.py

module msn_slip #(
  parameter  int unsigned Channels   = 8,
  parameter  int unsigned DetailBits = 18,
  parameter  int unsigned TimerBits  = 16,
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
  input  logic                         actuator_moving_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic        [DetailBits-1:0] in_p2p_i,
  input  logic signed [DetailBits-1:0] in_total_i,
  input  logic        [IdBits-1:0]     in_id_i,
  input  logic                         in_last_i,
  input  logic                         in_restart_i,
  input  logic                         in_end_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic        [2:0]            out_state_o,  // msn_pkg::slip_state_e
  output logic                         out_raised_o,
  output logic                         out_over_o,
  output logic        [DetailBits-1:0] out_p2p_o,
  output logic        [IdBits-1:0]     out_id_o,
  output logic                         out_last_o,
  output logic                         out_end_o,

  output logic        [31:0]           blanked_o     // details that were over while blanked or moving
);

  if (Channels < 1 || Channels > 1024) begin : gen_check_channels
    $fatal(1, "msn_slip: Channels = %0d must lie in 1 .. 1024", Channels);
  end
  if (TimerBits < 1 || TimerBits > 31) begin : gen_check_timer_bits
    $fatal(1, "msn_slip: TimerBits = %0d must lie in 1 .. 31", TimerBits);
  end

  // 1: compare.
  logic                  seen_valid, seen_ready, pressed, lifted, over, gross, moving, restart;
  logic [DetailBits-1:0] seen_p2p;
  logic [IdBits-1:0]     seen_id;
  logic                  seen_last, seen_end;
  assign in_ready_o = seen_ready || !seen_valid;

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      seen_valid <= in_valid_i;
      pressed    <= cfg_contact_rises_i ? in_total_i >= cfg_contact_level_i
                                        : in_total_i <= cfg_contact_level_i;
      lifted     <= cfg_contact_rises_i ? in_total_i < cfg_release_level_i
                                        : in_total_i > cfg_release_level_i;
      over       <= in_p2p_i > cfg_threshold_i;
      gross      <= in_p2p_i > cfg_gross_threshold_i;
      moving     <= actuator_moving_i;
      restart    <= in_restart_i;
      seen_p2p   <= in_p2p_i;
      seen_id    <= in_id_i;
      seen_last  <= in_last_i;
      seen_end   <= in_end_i;
    end
    if (rst_i) seen_valid <= 1'b0;
  end

  // 2: step the state. hold: details until a slip or a release is over; deaf: details until a slip may
  // be raised; blanking: deaf because of a contact onset.
  typedef struct packed {
    msn_pkg::slip_state_e state;
    logic                 blanking;
    logic [TimerBits-1:0] hold;
    logic [TimerBits-1:0] deaf;
  } memory_t;
  localparam int unsigned MemoryBits = 3 + 1 + 2 * TimerBits;

  memory_t               kept, now, next;
  logic [MemoryBits-1:0] kept_bits;
  logic                  step, no_hold, no_deaf, blank_this;
  assign seen_ready = out_ready_i || !out_valid_o;
  assign step       = seen_valid && seen_ready;

  msn_delay #(.Depth(Channels), .Width(MemoryBits)) u_memory (
    .clk_i,
    .rst_i,
    .step_i    (step),
    .in_data_i (next),
    .out_data_o(kept_bits)
  );
  assign kept = memory_t'(kept_bits);

  always_comb begin
    now = kept;
    if (restart) now = '0;  // state None
    no_hold    = now.hold == '0;
    no_deaf    = now.deaf == '0;
    next       = now;
    blank_this = 1'b0;
    unique case (now.state)
      msn_pkg::Contact: begin
        blank_this = over && (moving || (now.blanking && !no_deaf));
        if (lifted) begin
          next.state = msn_pkg::Release;
          next.hold  = cfg_hold_i;
          next.deaf  = '0;
          blank_this = 1'b0;
        end else if (over && !moving && no_deaf) begin
          next.state = gross ? msn_pkg::Gross : msn_pkg::Incipient;
          next.hold  = cfg_hold_i;
        end else if (!no_deaf) begin
          next.deaf = now.deaf - 1'b1;
        end
      end
      msn_pkg::Incipient, msn_pkg::Gross: begin
        if (lifted) begin
          next.state = msn_pkg::Release;
          next.hold  = cfg_hold_i;
          next.deaf  = '0;
        end else begin
          blank_this = over && moving;
          if (over && !moving) begin
            next.hold = cfg_hold_i;
            if (gross) next.state = msn_pkg::Gross;
          end else if (!no_hold) begin
            next.hold = now.hold - 1'b1;
          end else begin
            next.state    = msn_pkg::Contact;
            next.deaf     = cfg_refractory_i;
            next.blanking = 1'b0;
          end
        end
      end
      default: begin  // None, Release, and the codes that no state has
        if (pressed) begin
          next.state    = msn_pkg::Contact;
          next.hold     = '0;
          next.deaf     = cfg_blank_i;
          next.blanking = 1'b1;
        end else if (now.state == msn_pkg::Release && !no_hold) begin
          next.hold = now.hold - 1'b1;
        end else begin
          next.state = msn_pkg::None;
        end
      end
    endcase
  end

  logic slipping, was_slipping;
  assign slipping     = next.state == msn_pkg::Incipient || next.state == msn_pkg::Gross;
  assign was_slipping = now.state == msn_pkg::Incipient || now.state == msn_pkg::Gross;

  always_ff @(posedge clk_i) begin
    if (seen_ready) begin
      out_valid_o  <= seen_valid;
      out_state_o  <= next.state;
      out_raised_o <= slipping && !was_slipping;
      out_over_o   <= over;
      out_p2p_o    <= seen_p2p;
      out_id_o     <= seen_id;
      out_last_o   <= seen_last;
      out_end_o    <= seen_end;
    end
    if (step && blank_this) blanked_o <= blanked_o + 1'b1;
    if (rst_i) begin
      out_valid_o <= 1'b0;
      blanked_o   <= '0;
    end
  end

endmodule
