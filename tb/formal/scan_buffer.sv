// SPDX-License-Identifier: Apache-2.0
//
// Complete frames in natural order or interleaved leave row by row, each beat once, with its number and its data;
// a frame that arrives while the one before is still here is dropped entirely, and counted. No place is read in the
// clock in which it is written. Beats of a frame arrive in order; a ring's sender obeys room_o (assumed: at most two
// beats after it fell).

module formal_scan_buffer #(
  parameter  int unsigned Rows     = 2,
  parameter  int unsigned Beats    = 2,
  parameter  int unsigned Burst    = 1,
  parameter  int unsigned Width    = 1,
  parameter  int unsigned Depth    = Rows * Beats,
  localparam int unsigned IdBits   = msn_pkg::index_width(Rows * Beats)
) (
  input logic             clk_i,
  input logic             rst_i,
  input logic             in_valid_i,
  input logic             in_interleave_i,
  input logic [Width-1:0] in_data_i,
  input logic             out_ready_i
);

  localparam bit Sorts = Depth >= Rows * Beats;

  // The incoming frame: its rows and beats so far, and the place of the next beat.
  logic                started = 1'b0;
  logic                in_first_i, interleave, room_o, out_valid_o, out_last_o, taken_o;
  logic [Width-1:0]    out_data_o;
  logic [IdBits-1:0]   out_id_o;
  logic [31:0]         dropped_o;
  logic [3:0]          row, beat, rows_done;
  msn_scan_buffer #(.Rows(Rows), .Beats(Beats), .Burst(Burst), .Width(Width), .Depth(Depth)) dut (.*);

  // What the present frame should send: by place, row-major.
  logic [3:0]                   due_row, due_beat, dropped;
  logic [Rows*Beats*Width-1:0]  stored;
  logic [Rows*Beats-1:0]        there;
  logic                         mine, ends, turned;   // the incoming frame is the one that will leave
  logic                         cur_interleave, cur_mine;
  assign in_first_i     = row == 0 && beat == 0 && rows_done == 0;
  assign cur_interleave = in_first_i ? in_interleave_i && Sorts : interleave;
  assign cur_mine       = in_first_i ? taken_o : mine;
  assign ends           = beat == 4'(Beats - 1) && rows_done == 4'(Rows - 1);
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    turned  <= 1'b0;
    dropped <= dropped + 4'(turned);
    if (in_valid_i) begin
      if (in_first_i) begin
        interleave <= in_interleave_i && Sorts;
        mine       <= taken_o;
        turned     <= !taken_o;
      end
      beat <= (beat == 4'(Beats - 1)) ? 0 : beat + 1;
      if (beat == 4'(Beats - 1)) begin
        rows_done <= ends ? 0 : rows_done + 1;
        row       <= ends ? 0 : !cur_interleave ? row + 1 : (32'(row) + 2 < Rows) ? row + 2 : 1;
      end
      if (cur_mine) begin
        for (int unsigned i = 0; i < Rows * Beats; i++) begin
          if (i == 32'(row) * Beats + 32'(beat)) begin
            stored[i*Width+:Width] <= in_data_i;
            there[i]               <= 1'b1;
          end else if (in_first_i) there[i] <= 1'b0;
        end
      end
    end
    if (taken_o) begin
      due_row  <= 0;
      due_beat <= 0;
    end else if (out_valid_o && out_ready_i) begin
      due_beat <= (due_beat == 4'(Beats - 1)) ? 0 : due_beat + 1;
      due_row  <= due_row + 4'(due_beat == 4'(Beats - 1));
    end
    if (rst_i) begin
      {row, beat, rows_done, dropped, due_row, due_beat} <= '0;
      there  <= '0;
      mine   <= 1'b0;
      turned <= 1'b0;
    end
  end

  // A ring: a beat may arrive if there was room a clock ago.
  logic room_q;
  always_ff @(posedge clk_i) room_q <= room_o;

  logic [Width-1:0] due;
  logic             is_there;
  always_comb begin
    due      = '0;
    is_there = 1'b0;
    for (int unsigned i = 0; i < Rows * Beats; i++) begin
      if (i == 32'(due_row) * Beats + 32'(due_beat)) begin
        due      = stored[i*Width+:Width];
        is_there = there[i];
      end
    end
  end
  always_comb begin
    if (!started) assume (rst_i);
    if (rst_i) assume (!in_valid_i);
    if (!Sorts && in_valid_i) assume (room_o || room_q);
    if (started && !rst_i) begin
      assert (dropped_o[3:0] == dropped);
      if (out_valid_o) begin
        assert (is_there && out_data_o == due && 32'(out_id_o) == 32'(due_row) * Beats + 32'(due_beat));
        assert (out_last_o == (due_row == 4'(Rows - 1) && due_beat == 4'(Beats - 1)) && 32'(due_row) < Rows);
      end
      // Reading a place in the clock in which it is written is undefined.
      if (dut.store && dut.step) assert (32'(dut.in_address) != 32'(dut.id_q) % Depth);
      cover (out_valid_o && out_last_o && due_row != 0 && (Beats == 1 || due_beat != 0) && interleave == Sorts);
      cover (dropped_o != '0);
    end
  end



endmodule
