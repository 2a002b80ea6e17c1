// SPDX-License-Identifier: Apache-2.0
//
// Splits msn_health's events, which have the faults of all taxels of a beat, into reports of single taxels.
//
//   taxel = row*Columns + beat*Lanes + lane     faults = 1 dead + 2 railed + 4 blinking; healthy taxels are skipped
//
// with id = row*RowBeats + beat. A lane a clock; the next event is taken when the last lane is done. If the columns do
// not fill a row's last beat, a clock before for each row above: rows are counted off the id, without a division.
// Error: none.
// Model: model/meissner/twins/frontend/health.py

module msn_health_report #(
  parameter  int unsigned IdBits    = 9,
  parameter  int unsigned Lanes     = 8,
  parameter  int unsigned Columns   = Lanes,
  localparam int unsigned RowBeats  = (Columns + Lanes - 1) / Lanes,
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
    $fatal(1, "msn_health_report: Lanes = %0d must lie in 1 .. 8", Lanes);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_health_report: Columns = %0d must lie in 1 .. 1024", Columns);
  end

  localparam bit Full = RowBeats * Lanes == Columns;  // taxels are numbered as the lanes are

  logic                busy, below;
  logic [IdBits-1:0]   id;     // of the rows not counted off
  logic [23:0]         above;  // taxels of those that are
  logic [LaneBits-1:0] lane;
  logic [Lanes-1:0]    dead, railed, blinking;
  assign in_ready_o   = !busy;
  assign out_faults_o = {5'd0, blinking[0], railed[0], dead[0]};
  assign below        = !Full && 32'(id) >= RowBeats;
  assign out_valid_o  = busy && !below && (out_faults_o != '0);
  assign out_id_o     = (Full ? '0 : above) + 24'(id) * 24'(Lanes) + 24'(lane);

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      busy  <= in_valid_i;
      id    <= in_id_i;
      lane  <= '0;
      above <= '0;
      {dead, railed, blinking} <= {in_dead_i, in_railed_i, in_blinking_i};
    end else if (below) begin
      id    <= id - IdBits'(RowBeats);
      above <= above + 24'(Columns);
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
