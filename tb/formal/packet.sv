// SPDX-License-Identifier: Apache-2.0
//
// Bytes of a packet: type, number, six of time, as many of payload as the type has (images: two a taxel, Chunk taxels
// at the most), four of the CRC-32 of all before, computed here a bit at a time; `last` on the final one and nowhere
// else; numbers count up. A byte holds until it is taken.

module formal_packet #(
  parameter int unsigned SlipDepth     = 64,
  parameter bit          Cop           = 1'b1,
  parameter bit          Health        = 1'b1,
  parameter bit          Answers       = 1'b1,
  parameter int unsigned Statistics    = 4,
  parameter int unsigned StatisticBits = 20,
  parameter int unsigned Taxels        = 4096,
  parameter int unsigned Chunk         = 64
) (
  input logic        clk_i,
  input logic        rst_i,
  input logic        slip_valid_i,
  input logic        cop_valid_i,
  input logic        health_valid_i,
  input logic        answer_valid_i,
  input logic [63:0] answer_data_i,
  input logic        image_valid_i,
  input logic [15:0] image_data_i,
  input logic        image_last_i,
  input logic        out_ready_i
);

  logic        out_valid_o, out_last_o, out_begin_o;
  logic [7:0]  out_data_o;
  logic [31:0] packets_o;
  msn_packet #(
    .SlipDepth(SlipDepth), .Cop(Cop), .Health(Health), .Answers(Answers), .Statistics(Statistics),
    .StatisticBits(StatisticBits), .Taxels(Taxels), .Chunk(Chunk)
  ) dut (
    .clk_i, .rst_i, .slip_valid_i, .cop_valid_i, .health_valid_i, .answer_valid_i, .answer_data_i,
    .image_valid_i, .image_data_i, .image_last_i, .out_begin_o, .out_valid_o, .out_ready_i, .out_data_o,
    .out_last_o, .packets_o
  );

  logic        started = 1'b0;
  logic        give, stalled, last;
  logic [7:0]  data, kind, number, count;  // of the packet: type, number; packets so far
  logic [8:0]  place;                      // bytes taken of this packet
  logic [2:0]  checks;                     // of its checksum
  logic [31:0] crc, crc_next;
  logic [8:0]  length;                     // before the checksum, but of images
  logic        image, checking;
  assign give   = out_valid_o && out_ready_i;
  always_comb begin
    case (place == '0 ? out_data_o : kind)
      8'd1:    length = 9'd14;
      8'd2:    length = 9'd20;
      8'd3:    length = 9'd13;
      8'd4:    length = 9'd12;
      8'd5:    length = 9'd13;
      8'd16:   length = 9'd16;
      default: length = 9'd0;
    endcase
    crc_next = crc;
    for (int unsigned i = 0; i < 8; i++) begin
      crc_next = (crc_next >> 1) ^ ((crc_next[0] != (out_data_o[i] ^ checking)) ? 32'hEDB8_8320 : 32'h0);
    end
  end
  assign image = kind == 8'd3;
  // Of an image the checksum's place is where the block puts it: checks below that it may be there.
  logic image_checks;
  assign checking = image ? image_checks : place >= length && place != '0;

  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    stalled <= out_valid_o && !out_ready_i && !rst_i;
    data    <= out_data_o;
    last    <= out_last_o;
    if (give) begin
      place <= place + 1'b1;
      crc   <= crc_next;
      if (place == '0) kind <= out_data_o;
      if (place == 9'd1) number <= out_data_o;
      if (checking) checks <= checks + 1'b1;
      if (out_last_o) begin
        place  <= '0;
        checks <= '0;
        crc    <= '1;
        count  <= count + 1'b1;
      end
    end
    if (rst_i) begin
      place  <= '0;
      checks <= '0;
      crc    <= '1;
      count  <= '0;
    end
  end

  // The block has put its next byte of the checksum into out_data_o: the state moved on with the byte before.
  logic ahead;  // bytes of the checksum that the block has sent or shows
  assign image_checks = dut.state == 2'd3 ? !(out_valid_o && dut.left == 5'd3) : dut.state == 2'd0;

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      if (stalled) assert (out_valid_o && out_data_o == data && out_last_o == last);
      if (out_valid_o) begin
        if (place == '0) assert (length != '0);
        if (place == 9'd1) assert (out_data_o == count);
        if (checking) assert (out_data_o == ~crc[7:0]);
        assert (out_last_o == (checking && checks == 3'd3));
        if (checking && image && checks == '0) assert (place > length && place <= length + 9'(2 * Chunk) && !place[0] == !length[0]);
      end
    end
  end

  // Invariant.
  logic       busy;
  assign busy = dut.state != 2'd0 || out_valid_o;
  logic [8:0] sent;
  logic [2:0] checks_sent;
  assign sent        = place + 9'(out_valid_o);
  assign checks_sent = checks + 3'(out_valid_o && checking);
  logic [8:0] record;
  logic       turn;  // the record is taken in this clock
  assign turn = dut.turn != '0;
  always_ff @(posedge clk_i) if (turn) record <= 9'd8 + 9'(dut.chosen[11:8]);
  logic [7:0] type_q;
  always_ff @(posedge clk_i) if (turn) type_q <= dut.chosen[7:0];
  logic [8:0] known;  // of the type the block has
  always_comb begin
    case (type_q)
      8'd1:    known = 9'd14;
      8'd2:    known = 9'd20;
      8'd3:    known = 9'd13;
      8'd4:    known = 9'd12;
      8'd5:    known = 9'd13;
      8'd16:   known = 9'd16;
      default: known = 9'd0;
    endcase
  end
  always_comb begin
    if (started) begin
      assert (count + 8'(busy && !turn) == dut.packets_o[7:0]);
      assert ((dut.turn & (dut.turn - 1'b1)) == '0);
      if (turn) assert (dut.state == 2'd1 && dut.phase == '0 && sent == '0 && checks == '0);
      if (busy && !turn) begin
        assert (record == known && known != '0 && dut.pixels == (type_q == 8'd3));
        if (place != '0) assert (kind == type_q);
        if (place == '0 && out_valid_o) assert (out_data_o == type_q);
      end
      case (dut.state)
        2'd0: begin
          if (out_valid_o) assert (out_last_o && checks == 3'd3 && (type_q == 8'd3 || sent == record + 9'd4));
          else assert (place == '0 && checks == '0 && crc == '1);
        end
        2'd1: if (!turn) begin
          assert (sent < record && checks == '0 && sent + 9'(dut.left) + 9'd1 == record && !(out_valid_o && out_last_o));
          if (sent == '0) assert (dut.bytes[7:0] == type_q && dut.bytes[15:8] == count);
          if (sent == 9'd1) assert (dut.bytes[7:0] == count);
        end
        2'd2: begin
          assert (checks == '0 && type_q == 8'd3 && dut.pixels && sent >= record && !(out_valid_o && out_last_o));
          assert (dut.upper == (sent[0] != record[0]));
        end
        default: begin
          assert (dut.left <= 5'd3 && !(out_valid_o && out_last_o) && sent >= record);
          assert (checks_sent == 3'd3 - 3'(dut.left) && checks_sent <= 3'd3);
          if (type_q != 8'd3) assert (sent == record + 9'(checks_sent));
        end
      endcase
      assert (place <= 9'd260);
      if (!dut.idle || out_valid_o) assert (dut.crc == (out_valid_o ? crc_next : crc));
      if (out_valid_o && place == 9'd1) assert (out_data_o == count);
    end
  end

  // Of an image: taxels that are left, and what has been sent of it.
  if (Taxels == 0) begin : gen_no_image
    always_comb if (started && busy && !turn) assert (type_q != 8'd3);
  end else begin : gen_image
    logic [8:0] pixels;
    assign pixels = sent - record - 9'(checks_sent);
    always_comb begin
      if (started && busy && type_q == 8'd3) begin
        if (dut.state == 2'd1 && !turn) assert (dut.gen_image.left == 7'(Chunk - 1));
        if (dut.state == 2'd2) assert (pixels[8:1] <= 8'(Chunk - 1) && 8'(dut.gen_image.left) == 8'(Chunk - 1) - pixels[8:1]);
        if (dut.state == 2'd3) assert (pixels >= 9'd2 && pixels <= 9'(2 * Chunk) && !pixels[0]);
        if (dut.state == 2'd0) assert (sent - record >= 9'd6 && sent - record <= 9'(2 * Chunk + 4) && sent[0] == record[0]);
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (give && place == 9'd2 && kind == 8'd16);
      cover (give && stalled && place == 9'd1 && kind == 8'd2);
    end
  end

endmodule
