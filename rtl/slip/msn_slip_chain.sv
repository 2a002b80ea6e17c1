// SPDX-License-Identifier: Apache-2.0
//
// Slip of every channel or taxel of a core.
//
//   samples ─ skid (Array) ─ slip_path ─ skid (Array of several lanes) ─┬─ decisions, verdicts
//   decisions about a centre of pressure (Slip = 0) ────────────────────┴─ slip_flags
//
// The path of ready back through packet, slip, array and scan is long. For an array, skids cut it on both sides of
// the slip path. Latency: that of msn_slip_path, and a clock for each skid that holds a word.
// Model: model/meissner/twins/slip/slip_chain.py

module msn_slip_chain #(
  parameter  bit          Slip       = 1'b1,
  parameter  bit          Array      = 1'b0,
  parameter  int unsigned Lanes      = 1,     // of the array
  parameter  int unsigned Channels   = 1,
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Level      = 1,
  parameter  int unsigned Window     = 64,
  parameter  int unsigned Hop        = 64,
  parameter  int unsigned TimerBits  = 16,
  parameter  bit          Mask       = 1'b0,
  parameter  bit          Serial     = 1'b0,
  localparam int unsigned IdBits     = msn_pkg::index_width(Channels)
) (
  input  logic                            clk_i,
  input  logic                            rst_i,

  input  msn_registers_pkg::slip_cfg_t    cfg_i,
  output msn_registers_pkg::slip_status_t status_o,
  input  logic                            actuator_moving_i,  // a pin

  input  logic                            in_valid_i,
  output logic                            in_ready_o,
  input  logic signed [SampleBits-1:0]    in_data_i,
  input  logic        [IdBits-1:0]        in_id_i,
  input  logic                            in_last_i,
  input  logic                            in_mask_i,

  input  logic                            cop_valid_i,        // msn_cop_slip's
  output logic                            cop_ready_o,
  input  msn_pkg::decision_t              cop_i,

  output logic                            out_valid_o,
  input  logic                            out_ready_i,
  output msn_pkg::decision_t              out_o,
  output msn_pkg::verdict_t               verdict_o,          // of single channels; without back-pressure
  output logic                            busy_o,             // part of a frame is in this block
  output logic                            slip_o,             // of any channel
  output logic                            gross_o,
  output logic                            touched_o
);

  localparam int unsigned DetailBits = SampleBits + Level;

  logic offered;  // flags and reflex have already used this decision, which waits for the packet's sender

  if (Slip) begin : gen_slip
    logic                         sample_valid, sample_ready, sample_last, sample_mask;
    logic signed [SampleBits-1:0] sample;
    logic        [IdBits-1:0]     sample_id;
    if (Array) begin : gen_skid
      msn_skid #(.Width(SampleBits + IdBits + 2)) u_skid (
        .clk_i, .rst_i,
        .in_valid_i, .in_ready_o, .in_data_i({in_data_i, in_id_i, in_last_i, in_mask_i}),
        .out_valid_o(sample_valid), .out_ready_i(sample_ready),
        .out_data_o({sample, sample_id, sample_last, sample_mask})
      );
    end else begin : gen_no_skid
      assign {sample_valid, in_ready_o} = {in_valid_i, sample_ready};
      assign {sample, sample_id, sample_last, sample_mask} = {in_data_i, in_id_i, in_last_i, in_mask_i};
    end

    // An asynchronous pin: synchronised, so that all flip-flops that use it see the same value.
    logic moving;
    msn_sync u_moving (
      .clk_i, .in_data_i(actuator_moving_i), .out_data_o(moving)
    );

    logic                  found_valid, found_ready, found_raised, found_last, path_busy;
    msn_pkg::slip_state_e  found_state;
    logic [DetailBits-1:0] found_p2p, p2p;
    logic [IdBits-1:0]     found_id, id;
    logic                  found_over, found_end;
    msn_slip_path #(
      .Channels(Channels), .SampleBits(SampleBits), .Level(Level), .Window(Window), .Hop(Hop),
      .TimerBits(TimerBits), .Mask(Mask), .Serial(Serial)
    ) u_slip_path (
      .clk_i, .rst_i,
      .cfg_i,
      .actuator_moving_i(moving),
      .in_valid_i(sample_valid), .in_ready_o(sample_ready), .in_data_i(sample), .in_id_i(sample_id),
      .in_last_i(sample_last), .in_mask_i(sample_mask),
      .out_valid_o(found_valid), .out_ready_i(found_ready), .out_state_o(found_state),
      .out_raised_o(found_raised), .out_over_o(found_over), .out_p2p_o(found_p2p), .out_id_o(found_id),
      .out_last_o(found_last), .out_end_o(found_end),
      .busy_o(path_busy), .damaged_o(status_o.damaged), .blanked_o(status_o.blanked)
    );

    if (Array && Lanes > 1) begin : gen_decision_skid
      msn_skid #(.Width(DetailBits + IdBits + 5)) u_skid (
        .clk_i, .rst_i,
        .in_valid_i(found_valid), .in_ready_o(found_ready),
        .in_data_i({found_raised, found_last, found_state, found_p2p, found_id}),
        .out_valid_o, .out_ready_i, .out_data_o({out_o.raised, out_o.last, out_o.state, p2p, id})
      );
      assign verdict_o = '0;
      logic unused_found;
      assign unused_found = ^{found_over, found_end};
    end else begin : gen_no_decision_skid
      assign {out_valid_o, found_ready} = {found_valid, out_ready_i};
      assign {out_o.raised, out_o.last, out_o.state} = {found_raised, found_last, found_state};
      assign {p2p, id} = {found_p2p, found_id};
      assign verdict_o = {found_valid && !offered, found_over, found_end, 16'(found_id)};
    end
    assign out_o.p2p = 24'(p2p);
    assign out_o.id  = 16'(id);
    assign busy_o    = sample_valid || path_busy || out_valid_o;
    logic unused_cop;
    assign unused_cop = ^{cop_valid_i, cop_i};
    assign cop_ready_o = 1'b0;
  end else begin : gen_no_slip
    assign {out_valid_o, cop_ready_o, out_o} = {cop_valid_i, out_ready_i, cop_i};
    assign in_ready_o = 1'b1;
    assign {busy_o, status_o, verdict_o} = '0;
    logic unused_slip;
    assign unused_slip = ^{cfg_i, actuator_moving_i, in_valid_i, in_data_i, in_id_i, in_last_i, in_mask_i};
  end

  always_ff @(posedge clk_i) offered <= !rst_i && out_valid_o && !out_ready_i;
  msn_slip_flags u_flags (
    .clk_i, .rst_i,
    .in_valid_i(out_valid_o && !offered), .in_state_i(out_o.state),
    .in_first_i(out_o.id == '0), .in_last_i(out_o.last),
    .slip_o, .gross_o, .touched_o
  );

endmodule
