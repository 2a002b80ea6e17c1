// SPDX-License-Identifier: Apache-2.0
//
// Packets byte by byte and clock by clock: which waiting source is chosen; type, number, time and payload as received
// at the ports (events: from the queue, proof `fifo`; taxels and time of an image: from its store); an image's packets
// have Chunk taxels, or the rest of the image; the CRC-32 of all bytes before it, computed here bit by bit; `last` on
// the final byte. A byte holds until it is taken, and the next follows within 4 clocks. The counters.

module formal_packet #(
  parameter  int unsigned SlipDepth     = 64,
  parameter  int unsigned States        = 0,
  parameter  int unsigned FirstState    = 0,
  parameter  bit          Cop           = 1'b1,
  parameter  bit          Classes       = 1'b0,
  parameter  bit          Health        = 1'b1,
  parameter  bit          Answers       = 1'b1,
  parameter  int unsigned Statistics    = 4,
  parameter  int unsigned StatisticBits = 20,
  parameter  int unsigned Taxels        = 4096,
  parameter  int unsigned Chunk         = 64,
  localparam int unsigned Counters      = (Statistics > 0) ? Statistics : 1,
  localparam int unsigned StateBits     = msn_pkg::index_width(States)
) (
  input logic                   clk_i,
  input logic                   rst_i,
  input logic [47:0]            now_i,
  input logic                   slip_valid_i,
  input logic [15:0]            slip_id_i,
  input msn_pkg::slip_state_e   slip_state_i,
  input msn_pkg::slip_state_e   slip_told_i,
  input logic                   slip_start_i,
  input logic                   slip_late_i,
  input logic [23:0]            slip_p2p_i,
  input logic [47:0]            slip_time_i,
  input logic                   class_valid_i,
  input logic [15:0]            class_label_i,
  input logic [15:0]            class_told_i,
  input logic [31:0]            class_votes_i,
  input logic [47:0]            class_stamp_i,
  input logic                   cop_valid_i,
  input logic [23:0]            cop_x_i,
  input logic [23:0]            cop_y_i,
  input logic [39:0]            cop_load_i,
  input logic                   cop_pressed_i,
  input logic [47:0]            cop_time_i,
  input logic                   health_valid_i,
  input logic [23:0]            health_id_i,
  input logic [7:0]             health_faults_i,
  input logic                   states_i,
  input msn_pkg::slip_state_e   states_state_i,
  input logic                   answer_valid_i,
  input logic [63:0]            answer_data_i,
  input logic [Counters*32-1:0] statistics_i,
  input logic                   image_valid_i,
  input logic [15:0]            image_data_i,
  input logic                   image_last_i,
  input logic [47:0]            image_time_i,
  input logic                   out_ready_i
);

  msn_pkg::change_t   slip_i;
  msn_pkg::cop_t      cop_i;
  msn_pkg::health_t   health_i;
  msn_pkg::class_t    class_i;
  assign class_i  = {class_stamp_i, class_votes_i, class_told_i, class_label_i};
  assign slip_i   = {slip_start_i, slip_late_i, slip_told_i, slip_state_i, slip_p2p_i, slip_id_i};
  assign cop_i    = {cop_x_i, cop_y_i, cop_load_i, cop_pressed_i};
  assign health_i = {health_id_i, health_faults_i};

  logic        slip_ready_o, slip_room_o;
  logic [StateBits-1:0] states_id_o;
  logic        health_ready_o, class_ready_o, answer_ready_o, out_begin_o, out_valid_o, out_last_o;
  logic [7:0]  out_data_o;
  logic [31:0] packets_o, cop_dropped_o, image_dropped_o;
  msn_packet #(
    .SlipDepth(SlipDepth), .States(States), .FirstState(FirstState), .Cop(Cop), .Classes(Classes), .Health(Health), .Answers(Answers), .Statistics(Statistics),
    .StatisticBits(StatisticBits), .Taxels(Taxels), .Chunk(Chunk)
  ) dut (.*);

  typedef enum logic [2:0] {
    Slip, Answer, StateReport, ClassChange, CopResult, HealthReport, Statistic, Image
  } source_e;
  localparam logic [7:0] First = 8'd1;

  // The waiting sources, each with its payload, its length and its time.
  logic         started = 1'b0;
  logic         run;       // a packet has been chosen, and not all its bytes have left
  logic [7:0]   waits, turn;
  logic         yields;    // the last packet was a change, so the others go first once
  logic [5:0]   others;
  logic [2:0]   changes;   // since an image's packet, at most 7
  logic         class_waits, cop_waits, health_waits, statistic_waits, idle;
  logic [63:0]  classified;
  logic [47:0]  class_time;
  logic [88:0]  cop;
  logic [47:0]  cop_time, health_time;
  logic [31:0]  health, counter, cop_dropped, packets;
  logic [7:0]   which, image_number;
  logic [StatisticBits-1:0] pause;
  logic [16:0]  place, place_end;  // in the image; after this packet
  logic [47:0]  slip_time, image_time;
  logic [47:0]  slip_event;
  logic         slip_start;
  assign place_end = (32'(place) + Chunk >= Taxels) ? 17'(Taxels) : place + 17'(Chunk);
  if (SlipDepth > 0) begin : gen_slip
    msn_pkg::change_t change;
    assign {change, slip_time} = {dut.gen_slip.change, dut.gen_slip.change_time};
    assign slip_start = change.start;
    assign slip_event = {change.start ? 5'd0 : {change.late, change.told, 1'b0}, change.state, change.p2p, change.id};
  end else begin : gen_no_slip
    assign {slip_event, slip_time, slip_start} = '0;
  end
  assign idle  = !run && !out_valid_o;
  assign waits = {Taxels > 0 && dut.image_valid, Statistics > 0 && statistic_waits, Health && health_waits, Cop && cop_waits,
                  Classes && class_waits, States > 0 && dut.states_valid, Answers && answer_valid_i, SlipDepth > 0 && dut.slip_valid && (slip_start || !((yields && others != '0) || (changes == 3'd7 && Taxels > 0 && dut.image_valid)))};
  assign others = {Statistics > 0 && statistic_waits, Health && health_waits, Cop && cop_waits,
                   Classes && class_waits, States > 0 && dut.states_valid, Answers && answer_valid_i};
  always_ff @(posedge clk_i) begin
    cop_waits       <= cop_valid_i || (cop_waits && !turn[CopResult]);
    cop_dropped     <= cop_dropped + 32'(Cop && cop_valid_i && cop_waits && !turn[CopResult]);
    class_waits     <= class_waits ? !turn[ClassChange] : class_valid_i;
    if (!class_waits) {classified, class_time} <= {class_votes_i, class_told_i, class_label_i, class_stamp_i};
    health_waits    <= health_waits ? !turn[HealthReport] : health_valid_i;
    statistic_waits <= pause == '1 || (statistic_waits && !turn[Statistic]);
    pause           <= pause + 1'b1;
    counter         <= statistics_i[32*(32'(which)%Counters)+:32];
    if (turn[Slip] ? !slip_start : turn != '0) yields <= turn[Slip];
    if (turn[Image]) changes <= '0;
    else if (turn[Slip] && !slip_start && changes != 3'd7) changes <= changes + 1'b1;
    if (cop_valid_i) {cop, cop_time} <= {cop_pressed_i, cop_load_i, cop_y_i, cop_x_i, cop_time_i};
    if (!health_waits) {health, health_time} <= {health_faults_i, health_id_i, now_i};
    if (turn[Statistic]) which <= (32'(which) == Statistics - 1) ? '0 : which + 1'b1;
    if (rst_i) begin
      cop_waits       <= 1'b0;
      cop_dropped     <= '0;
      health_waits    <= 1'b0;
      class_waits     <= 1'b0;
      statistic_waits <= 1'b0;
      pause           <= '0;
      yields          <= 1'b0;
      changes         <= '0;
      which           <= '0;
    end
  end

  // The packet under way: its bytes except taxels and checksum, and the length of each part.
  logic [159:0] record;
  logic [8:0]   sent, first, second;  // bytes; bytes before the taxels, and before the checksum
  logic [8:0]   record_bytes, taxel_bytes;
  logic [1:0]   phase;
  logic [7:0]   data, byte_out;
  logic [31:0]  crc, crc_next;
  logic         valid, last, emit, image, odd;
  assign emit = run && turn == '0 && phase == 2'd3 && !out_valid_o;
  assign odd  = sent[0] != first[0];
  logic [159:0] rest;
  always_comb begin
    record = '0;
    for (int unsigned s = 0; s < 8; s++) if (turn[s]) begin
      case (source_e'(s))
        Slip:         record = 160'({slip_event, slip_time, packets[7:0], slip_start ? 8'd1 : 8'd6});
        Answer:       record = 160'({answer_data_i, now_i, packets[7:0], 8'd16});
        StateReport:  record = 160'({dut.states[91:60], now_i, packets[7:0], 8'd7});
        ClassChange:  record = 160'({classified, class_time, packets[7:0], 8'd8});
        CopResult:    record = 160'({cop, cop_time, packets[7:0], 8'd2});
        HealthReport: record = 160'({health, health_time, packets[7:0], 8'd4});
        Statistic:    record = 160'({counter, which, now_i, packets[7:0], 8'd5});
        default:      record = 160'({24'(place), 7'd0, 32'(place_end) == Taxels, image_number, image_time, packets[7:0], 8'd3});
      endcase
    end
    record_bytes = 9'd8 + (turn[Slip] ? 9'd6 : (turn[Answer] || turn[ClassChange]) ? 9'd8 : turn[CopResult] ? 9'd12 : (turn[HealthReport] || turn[StateReport]) ? 9'd4 : 9'd5);
    taxel_bytes  = turn[Image] ? 9'({place_end - place, 1'b0}) : '0;
    byte_out     = (sent < first) ? rest[7:0] : (sent >= second) ? ~crc[7:0] : odd ? dut.taxel[15:8] : dut.taxel[7:0];
    crc_next     = crc;
    for (int unsigned i = 0; i < 8; i++) crc_next = (crc_next >> 1) ^ ((crc_next[0] != byte_out[i]) ? 32'hEDB8_8320 : 32'h0);
    if (sent >= second) crc_next = crc >> 8;
  end
  always_ff @(posedge clk_i) begin
    started <= 1'b1;
    turn    <= idle ? waits & (~waits + First) : '0;
    if (idle && waits != '0) run <= 1'b1;
    if (out_ready_i) valid <= 1'b0;
    phase <= idle ? '0 : emit ? '0 : (phase == 2'd3) ? 2'd3 : phase + 1'b1;
    if (idle) crc <= '1;
    if (turn != '0) begin
      rest    <= record;
      sent    <= '0;
      first   <= record_bytes;
      second  <= record_bytes + taxel_bytes;
      image   <= turn[Image];
      packets <= packets + 1'b1;
    end
    if (emit) begin
      rest  <= rest >> 8;
      sent  <= sent + 1'b1;
      crc   <= crc_next;
      valid <= 1'b1;
      data  <= byte_out;
      last  <= sent == second + 9'd3;
      if (sent == second + 9'd3) run <= 1'b0;
      if (image && sent + 9'd1 == second) begin
        place <= (32'(place_end) == Taxels) ? '0 : place_end;
        if (32'(place_end) == Taxels) image_number <= image_number + 1'b1;
      end
    end
    if (rst_i) begin
      run          <= 1'b0;
      turn         <= '0;
      valid        <= 1'b0;
      packets      <= '0;
      place        <= '0;
      image_number <= '0;
    end
  end

  always_comb begin
    if (!started) assume (rst_i);
    if (started) begin
      assert (out_valid_o == valid && (!valid || (out_data_o == data && out_last_o == last)));
      assert (out_begin_o == (run || (SlipDepth > 0 && dut.slip_valid)) && dut.yields == yields && dut.changes == changes);
      assert (packets_o == packets && (!Cop || cop_dropped_o == cop_dropped));
      assert (class_ready_o == (Classes && !class_waits));
      assert (answer_ready_o == turn[Answer] && health_ready_o == (Health && !health_waits));
      assert (dut.slip_take == turn[Slip] && States == 0);  // the report: tests
    end
  end

  // Invariant.
  localparam logic [1:0] Record = 2'd1, Pixels = 2'd2, Check = 2'd3;
  always_comb begin
    if (started) begin
      assert (dut.turn == turn && dut.idle == idle && (turn & (turn - First)) == '0);
      if (Classes) assert (dut.class_valid == class_waits);
      if (Classes && class_waits) assert (dut.classes == 156'({classified, class_time, 4'd8, 8'd8}));
      if (turn[ClassChange]) assert (Classes && class_waits);
      if (Cop) assert (dut.cop_valid == cop_waits);
      if (Cop && cop_waits) assert (dut.cop == 156'({cop, cop_time, 4'd12, 8'd2}));
      if (Health) assert (dut.health_valid == health_waits);
      if (Health && health_waits) assert (dut.health == 156'({health, health_time, 4'd4, 8'd4}));
      if (Statistics > 0) assert (dut.statistic_valid == statistic_waits && 32'(which) < Counters);
      if (turn != '0) assert (run && !valid && dut.state == Record && phase == '0 && crc == '1);
      if (turn[Image]) assert (Taxels > 0);
      if (turn[Statistic]) assert (Statistics > 0 && statistic_waits);
      if (turn[HealthReport]) assert (Health && health_waits);
      if (turn[CopResult]) assert (Cop && cop_waits);
      if (turn[Answer]) assert (Answers);
      if (!run) begin
        assert (dut.state == 2'd0);
      end else begin
        assert (dut.phase == phase && dut.crc == crc);
        if (turn == '0) begin
          assert (first >= 9'd12 && first <= 9'd20 && sent <= second + 9'd3);
          assert (dut.state == (sent < first ? Record : sent < second ? Pixels : Check));
          if (sent < first) assert (9'(dut.left) == first - 9'd1 - sent && dut.bytes == rest);
          if (sent >= second) assert (9'(dut.left) == second + 9'd3 - sent);
          assert (dut.pixels == image);
          if (image) assert (Taxels > 0 && first == 9'd13 && second > first && second <= first + 9'(2 * Chunk) && second[0] == first[0]);
          else assert (second == first);
          if (sent < first || sent >= second) assert (!dut.upper);
          else assert (dut.upper == odd);
        end else assert (!dut.upper);
      end
    end
  end

  logic warm;
  always_ff @(posedge clk_i) warm <= started;
  if (Statistics > 0) begin : gen_statistics
    always_comb if (started) begin
      assert (dut.gen_statistics.wait_clocks == pause && dut.gen_statistics.index == which);
      if (warm) assert (dut.gen_statistics.counter == counter);
    end
  end

  // For an image: the place reached, which is the store's address, and when it has begun and ended.
  if (Taxels == 0) begin : gen_no_image
    assign image_time = '0;
  end else begin : gen_image
    assign image_time = dut.gen_image.image_time;
    logic [16:0] at;
    logic        begun, done;
    logic [8:0]  pixels;  // bytes of this packet
    assign pixels = sent - first;
    assign at     = place + 17'(pixels[8:1]);
    always_ff @(posedge clk_i) begin
      if (turn[Image]) begun <= 1'b1;
      done <= emit && image && sent + 9'd1 == second && 32'(place_end) == Taxels && !rst_i;
      if (emit && image && sent + 9'd1 == second && 32'(place_end) == Taxels) begun <= 1'b0;
      if (rst_i) begun <= 1'b0;
    end
    always_comb if (started) begin
      assert (32'(place) < Taxels && dut.gen_image.number == image_number);
      assert (dut.gen_image.u_chunks.u_store.read_begun_i == (begun || turn[Image]) && dut.gen_image.u_chunks.u_store.read_done_i == done);
      assert (dut.gen_image.u_chunks.begun == begun);
      if (run && turn == '0 && image && sent >= first && sent < second) begin
        assert (17'(dut.gen_image.u_chunks.place) == at);
        assert (7'(dut.gen_image.u_chunks.left) == 7'(Chunk - 1) - 7'(pixels[8:1]) && second - first == 9'(2 * (place_end - place)));
      end else begin
        assert (17'(dut.gen_image.u_chunks.place) == place);
      end
      if (run && turn == '0 && image && sent < first) begin
        assert (dut.gen_image.u_chunks.left == 7'(Chunk - 1) && second - first == 9'(2 * (place_end - place)));
      end
    end
  end

  always_comb begin
    if (started && !rst_i) begin
      cover (emit && sent == 9'd2 && rest[7:0] == 8'h55);
      cover (emit && first == 9'd16 && sent == 9'd3 && rest[7:0] == 8'hAA);
      if (Health) cover (emit && first == 9'd12 && cop_waits && sent == 9'd1);
    end
  end

endmodule
