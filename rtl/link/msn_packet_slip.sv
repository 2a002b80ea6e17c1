// SPDX-License-Identifier: Apache-2.0
//
// Packets of one channel's changes alone, for the smallest builds: what msn_packet sends for them, made bit by
// bit from columns of one small memory, 64 bits deep. A sweep of 64 clocks visits every bit.
//
//   column 0   time / 64 in bits 6 .. 47, incremented in each sweep; packets so far in bits 56 .. 63
//   column 1   the same at the last convert start, whose low bits are in a register
//   column 2   the packet's head: time, type, number;   column 3   its payload: peak-to-peak, states, channel
//
// A change waits for its own sweep, 64 .. 191 clocks, that fills columns 2 and 3, and before that for the packet under
// way; room_o: there is none. Then a byte is captured when a sweep passes its bits, up to one in 72 clocks, and at the
// end the checksum is shifted out. out_begin_o rises with the change. The time is that of the last convert start
// before the change was offered, in clocks since reset. Convert starts while a change waits are not recorded: a
// change of a sample delayed by such a wait has the time of the last convert start before the wait.
// Error: none.
// Model: model/meissner/twins/link/packet.py

module msn_packet_slip #(
  parameter int unsigned P2pBits = 18
) (
  input  logic                 clk_i,
  input  logic                 rst_i,

  input  logic                 convert_i,

  input  logic                 in_valid_i,
  output logic                 in_ready_o,
  input  msn_pkg::change_t     in_i,
  output logic                 room_o,

  output logic                 out_begin_o,  // a packet follows or is under way
  output logic                 out_valid_o,
  input  logic                 out_ready_i,
  output logic [7:0]           out_data_o,
  output logic                 out_last_o
);

  if (P2pBits < 1 || P2pBits > 24) begin : gen_check_p2p_bits
    $fatal(1, "msn_packet_slip: P2pBits = %0d must lie in 1 .. 24", P2pBits);
  end

  logic turn, sending;
  assign room_o = !sending;

  // The sweep. The first one after reset clears column 0.
  logic [5:0] at, ahead;  // present bit, bit that the memory reads
  logic       clearing;
  assign ahead = at + 1'b1;
  assign turn  = &at;
  always_ff @(posedge clk_i) begin
    at <= ahead;
    if (turn) clearing <= 1'b0;
    if (rst_i) begin
      at       <= '0;
      clearing <= 1'b1;
    end
  end

  // Convert starts: those while a change waits are ignored.
  logic [5:0] low;  // of the time
  logic       mark, marked, snap;
  assign mark = convert_i && !in_valid_i;
  always_ff @(posedge clk_i) begin
    if (mark) low <= at;
    marked <= (marked || mark) && !turn;
    if (turn) snap <= marked || mark;
    if (rst_i) begin
      marked <= 1'b0;
      snap   <= 1'b0;
    end
  end

  // Changes: the sweep begins when the line is free and the sweep that records the last convert start is over.
  logic copy;
  assign in_ready_o  = copy && turn;
  assign out_begin_o = in_valid_i || sending;
  always_ff @(posedge clk_i) begin
    if (turn) copy <= in_valid_i && !sending && !marked && !copy;
    if (rst_i) copy <= 1'b0;
  end

  // The columns.
  (* no_rw_check, ram_style = "block" *) logic [3:0] memory [64];
  logic        count, stamp, head, load, carry;  // the present bits
  logic [7:0]  lows;
  logic [31:0] loads;
  logic [4:0]  past;
  assign past  = in_i.start ? '0 : {in_i.late, in_i.told, 1'b0};
  assign lows  = {2'b00, low};
  assign loads = {past, in_i.state, 24'(in_i.p2p[P2pBits-1:0])};

  // Where the head's next bit comes from, chosen a clock before the memory answers: below 6 the time's low bits, then
  // the stamp, from 48 on the type, from 56 on the number.
  logic [15:0] kind;  // 1 or 6
  assign kind = in_i.start ? 16'd1 : 16'd6;
  logic next_count, next_stamp, next_head, next_load, early, late, from_stamp, from_count, known, loaded;
  assign early      = ahead[5:3] == '0 && ahead[2:1] != 2'b11;
  assign late       = &ahead[5:4];
  assign next_count = (count ^ carry) && !clearing;
  assign next_stamp = snap ? count : stamp;
  assign next_head  = (copy ? from_stamp && stamp : head) || (copy && (from_count ? count : known));
  assign next_load  = copy ? loaded : load;

  always_ff @(posedge clk_i) begin
    from_stamp <= !early && !late;
    from_count <= late && ahead[3];
    known      <= early ? lows[ahead[2:0]] : late && kind[ahead[3:0]];
    loaded     <= loads[ahead[4:0]] && !ahead[5];
    {load, head, stamp, count} <= memory[ahead];
    memory[at] <= {next_load, next_head, next_stamp, next_count};
    carry      <= (carry && count) || at == 6'd5 || (copy && at == 6'd55);
    if (rst_i) carry <= 1'b0;
  end

  // Byte by byte: places 6, 7, 8 .. 13 are type, number and time, in blocks 6, 7, 0 .. 5 of the head; 14 .. 19 are
  // channel, peak-to-peak and states, in blocks 6, 7, 0 .. 3 of the load; 20 .. 23 the checksum.
  logic [4:0]  place;
  logic [31:0] crc;
  logic        crc_low;
  logic [30:0] unused_crc;
  logic        fill, full, checksum, fits, present, taken;
  assign {unused_crc, crc_low} = crc;
  assign checksum    = place[4] && place[2];
  assign fits        = checksum || ahead[5:3] == place[2:0];
  assign present     = (place[4] || &place[3:1]) ? load : head;
  assign out_valid_o = full;
  assign out_last_o  = checksum && (&place[1:0]);
  assign taken       = full && out_ready_i;

  always_ff @(posedge clk_i) begin
    if (&at[2:0]) fill <= sending && !full && !fill && fits;
    full <= (full && !out_ready_i) || (fill && (&at[2:0]));
    if (fill) out_data_o <= {checksum ? !crc_low : present, out_data_o[7:1]};
    if (!sending) place <= 5'd6;
    else if (taken) place <= place + 1'b1;
    sending <= (copy && turn) || (sending && !(taken && out_last_o));
    if (rst_i) begin
      fill    <= 1'b0;
      full    <= 1'b0;
      sending <= 1'b0;
    end
  end

  msn_crc32 #(.Bits(1)) u_crc (
    .clk_i, .clear_i(!sending), .step_i(fill), .in_data_i(checksum ? crc_low : present), .out_crc_o(crc)
  );

  logic unused_in;
  assign unused_in = ^in_i;

  // Reading a word in the clock in which it is written is undefined.
  msn_check u_read_is_not_written (.clk_i, .rst_i, .wrong_i(!rst_i && at == ahead));

endmodule
