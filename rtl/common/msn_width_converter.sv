// SPDX-License-Identifier: Apache-2.0
//
// Converts beats of Lanes taxels to single taxels, as channels 0 .. Rows*Columns-1, row by row. Unused lanes in a
// row's last beat are skipped. in_row_last_i: a mark of msn_frame_marker.
//
// Latency 0 clocks, a taxel a clock, a beat when its last taxel is taken.   Model: model/meissner/twins/common/handshake.py

module msn_width_converter #(
  parameter  int unsigned Rows     = 64,
  parameter  int unsigned Columns  = 64,
  parameter  int unsigned Lanes    = 8,
  parameter  int unsigned DataBits = 16,
  localparam int unsigned IdBits   = msn_pkg::index_width(Rows * Columns)
) (
  input  logic                      clk_i,
  input  logic                      rst_i,

  input  logic                      in_valid_i,
  output logic                      in_ready_o,
  input  logic [Lanes*DataBits-1:0] in_data_i,
  input  logic                      in_row_last_i,
  input  logic                      in_last_i,   // of the frame

  output logic                      out_valid_o,
  input  logic                      out_ready_i,
  output logic [DataBits-1:0]       out_data_o,
  output logic [IdBits-1:0]         out_id_o,
  output logic                      out_last_o
);

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_width_converter: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_width_converter: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_width_converter: Lanes = %0d must lie in 1 .. 8", Lanes);
  end

  localparam int unsigned LaneBits = msn_pkg::index_width(Lanes);

  logic [LaneBits-1:0] lane;
  logic                take, lane_end;
  assign lane_end    = lane == (in_row_last_i ? LaneBits'((Columns - 1) % Lanes) : LaneBits'(Lanes - 1));
  assign out_valid_o = in_valid_i;
  assign out_data_o  = in_data_i[lane*DataBits+:DataBits];
  assign out_last_o  = in_last_i && lane_end;
  assign in_ready_o  = out_ready_i && lane_end;
  assign take        = out_valid_o && out_ready_i;

  always_ff @(posedge clk_i) begin
    if (take) begin
      lane     <= lane_end ? '0 : lane + 1'b1;
      out_id_o <= out_last_o ? '0 : out_id_o + 1'b1;
    end
    if (rst_i) begin
      lane     <= '0;
      out_id_o <= '0;
    end
  end

endmodule
