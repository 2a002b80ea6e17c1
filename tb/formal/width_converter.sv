// SPDX-License-Identifier: Apache-2.0
//
// Every taxel of a beat that lies within the row leaves once, lowest lane first; the number counts from 0 after a
// frame's last beat. `beat`: place of the beat in its row; `sent`: its taxels that have left.

module formal_width_converter #(
  parameter  int unsigned Rows     = 64,
  parameter  int unsigned Columns  = 64,
  parameter  int unsigned Lanes    = 8,
  parameter  int unsigned DataBits = 16,
  localparam int unsigned IdBits   = msn_pkg::index_width(Rows * Columns)
) (
  input logic                      clk_i,
  input logic                      rst_i,
  input logic                      in_valid_i,
  input logic [Lanes*DataBits-1:0] in_data_i,
  input logic                      in_last_i,
  input logic                      out_ready_i
);

  logic                in_ready_o, out_valid_o, out_last_o;
  logic                in_row_last_i;  // as msn_frame_marker marks it
  logic [DataBits-1:0] out_data_o;
  logic [IdBits-1:0]   out_id_o;
  msn_width_converter #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes), .DataBits(DataBits)) dut (.*);

  localparam int unsigned Beats = (Columns + Lanes - 1) / Lanes;
  localparam int unsigned Final = Columns - (Beats - 1) * Lanes;  // taxels of a row's last beat

  logic                      started = 1'b0;
  logic                      stalled, take, give;
  logic [11:0]               beat;
  logic [3:0]                sent, own;
  logic [IdBits-1:0]         number;
  logic [Lanes*DataBits-1:0] data;
  logic                      last;
  assign take = in_valid_i && in_ready_o;
  assign give = out_valid_o && out_ready_i;
  assign own  = in_row_last_i ? 4'(Final) : 4'(Lanes);
  assign in_row_last_i = beat == 12'(Beats - 1);
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    stalled <= in_valid_i && !in_ready_o && !rst_i;
    data    <= in_data_i;
    last    <= in_last_i;
    if (give) begin
      sent   <= sent + 1'b1;
      number <= number + 1'b1;
    end
    if (take) begin
      sent <= '0;
      beat <= (in_last_i || beat == 12'(Beats - 1)) ? '0 : beat + 1'b1;
      if (in_last_i) number <= '0;
    end
    if (rst_i) begin
      sent   <= '0;
      beat   <= '0;
      number <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started && stalled) assume (in_valid_i && in_data_i == data && in_last_i == last);
    if (started && !rst_i) begin
      assert (out_valid_o == in_valid_i);
      if (take) assert (give && sent + 4'd1 == own);           // when its last taxel is taken
      if (give && sent + 4'd1 == own) assert (take);
      if (give) assert (out_data_o == DataBits'(in_data_i >> (sent * DataBits)));
      if (give) assert (out_id_o == number && out_last_o == (in_last_i && sent + 4'd1 == own));
    end
  end

  // Invariant.
  always_comb begin
    if (started) begin
      assert (beat < 12'(Beats) && sent < own);
      assert (4'(dut.lane) == sent);
      assert (out_id_o == number);
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (take && in_last_i && number != '0);
      cover (give && beat == 12'(1 % Beats) && out_data_o == '1 && sent == own - 4'd1);
      cover (stalled && !give);
    end
  end

endmodule
