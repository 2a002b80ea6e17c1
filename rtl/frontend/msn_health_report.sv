// SPDX-License-Identifier: Apache-2.0
//
// Splits msn_health's events, which have the faults of all taxels of a beat, into reports of single taxels.
//
//   taxel = id*Lanes + lane     faults = 1 dead + 2 railed + 4 blinking; healthy taxels are skipped
//
// A lane a clock; the next event is taken when the last lane is done.
// Error: none.
// Model: model/meissner/twins/frontend/health.py

module msn_health_report #(
  parameter  int unsigned IdBits    = 9,
  parameter  int unsigned Lanes     = 8,
  localparam int unsigned LaneBits  = msn_pkg::index_width(Lanes)
) (
  input  logic              clk_i,
  input  logic              rst_i,

  input  logic              in_valid_i,
  output logic              in_ready_o,
  input  logic [IdBits-1:0] in_id_i,
  input  logic [Lanes-1:0]  in_dead_i,
  input  logic [Lanes-1:0]  in_railed_i,
  input  logic [Lanes-1:0]  in_blinking_i,

  output logic              out_valid_o,
  input  logic              out_ready_i,
  output logic [23:0]       out_id_o,
  output logic [7:0]        out_faults_o
);

  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_health_report: Lanes = %0d must be 1, 2, 4 or 8", Lanes);
  end

  logic                busy;
  logic [IdBits-1:0]   id;
  logic [LaneBits-1:0] lane;
  logic [Lanes-1:0]    dead, railed, blinking;
  assign in_ready_o   = !busy;
  assign out_faults_o = {5'd0, blinking[0], railed[0], dead[0]};
  assign out_valid_o  = busy && (out_faults_o != '0);
  assign out_id_o     = 24'(id) * 24'(Lanes) + 24'(lane);

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      busy <= in_valid_i;
      id   <= in_id_i;
      lane <= '0;
      {dead, railed, blinking} <= {in_dead_i, in_railed_i, in_blinking_i};
    end else if (out_ready_i || !out_valid_o) begin
      busy     <= lane != LaneBits'(Lanes - 1);
      lane     <= lane + 1'b1;
      dead     <= (Lanes > 1) ? dead >> 1 : '0;
      railed   <= (Lanes > 1) ? railed >> 1 : '0;
      blinking <= (Lanes > 1) ? blinking >> 1 : '0;
    end
    if (rst_i) busy <= 1'b0;
  end

endmodule
