// SPDX-License-Identifier: Apache-2.0
//
// Packets of all kinds, as bytes: type, number, time (48 bits, lowest byte first), payload, CRC-32. Specification:
// docs/link.md. Waiting packets are sent in this order of priority:
//
//   slip          changes of channels' states, from a queue: slip_room_o falls when it is half full, slip_ready_o
//                 when it is full. After a change that starts no slip the others go first once, after seven of
//                 them an image's packet
//   answers       of the register bridge, never dropped
//   states        of all channels on request, up to 128 to a packet; msn_state_report
//   class         of the forest, one at a time: class_ready_o is low until its packet has begun
//   CoP           the newest; it replaces an older one not yet sent, which is counted
//   health        one at a time: health_ready_o is low until its packet has begun
//   statistics    one counter every 2^StatisticBits clocks, in turn
//   images        in packets of Chunk taxels, so that a change waits for at most one of them; msn_image_chunks
//
// At most a byte every 4 clocks. If no packet is under way, a change's first byte follows it by 8 clocks;
// out_begin_o, opening the frame, follows a change by 3, others by 4.   Model: model/meissner/twins/link/packet.py
// Error: none.

module msn_packet #(
  parameter  int unsigned SlipDepth     = 64,    // changes that can wait, a power of two; 0: none
  parameter  int unsigned States        = 0,     // channels whose states can be asked for
  parameter  int unsigned FirstState    = 0,     // as in msn_state_report
  parameter  bit          Cop           = 1'b1,
  parameter  bit          Classes       = 1'b0,  // the core has a forest
  parameter  bit          Health        = 1'b1,
  parameter  bit          Answers       = 1'b1,
  parameter  int unsigned Statistics    = 4,     // counters; 0: none
  parameter  int unsigned StatisticBits = 20,
  parameter  int unsigned Taxels        = 4096,  // of an image; 0: none
  parameter  int unsigned Chunk         = 64,    // taxels of an image in one packet
  localparam int unsigned Counters      = (Statistics > 0) ? Statistics : 1,
  localparam int unsigned StateBits     = msn_pkg::index_width(States)
) (
  input  logic                   clk_i,
  input  logic                   rst_i,

  input  logic [47:0]            now_i,            // of health, statistics and answers

  input  logic                   slip_valid_i,     // a change
  output logic                   slip_ready_o,
  output logic                   slip_room_o,
  input  msn_pkg::change_t       slip_i,
  input  logic [47:0]            slip_time_i,
  input  logic                   class_valid_i,
  output logic                   class_ready_o,
  input  msn_pkg::class_t        class_i,
  input  logic                   cop_valid_i,
  input  msn_pkg::cop_t          cop_i,
  input  logic [47:0]            cop_time_i,
  input  logic                   health_valid_i,
  output logic                   health_ready_o,
  input  msn_pkg::health_t       health_i,

  input  logic                   states_i,         // asks for the states
  output logic [StateBits-1:0]   states_id_o,
  input  msn_pkg::slip_state_e   states_state_i,   // of states_id_o, a clock later

  input  logic                   answer_valid_i,
  output logic                   answer_ready_o,
  input  logic [63:0]            answer_data_i,

  input  logic [Counters*32-1:0] statistics_i,

  input  logic                   image_valid_i,
  input  logic [15:0]            image_data_i,
  input  logic                   image_last_i,
  input  logic [47:0]            image_time_i,

  output logic                   out_begin_o,      // a packet follows or is under way
  output logic                   out_valid_o,
  input  logic                   out_ready_i,
  output logic [7:0]             out_data_o,
  output logic                   out_last_o,

  output logic [31:0]            packets_o,        // begun
  output logic [31:0]            cop_dropped_o,
  output logic [31:0]            image_dropped_o
);

  if (SlipDepth == 1 || !msn_pkg::is_power(SlipDepth)) begin : gen_check_slip_depth
    $fatal(1, "msn_packet: SlipDepth = %0d must be 0 or a power of two, 2 or more", SlipDepth);
  end
  if (Statistics > 256) begin : gen_check_statistics
    $fatal(1, "msn_packet: Statistics = %0d must lie in 0 .. 256", Statistics);
  end
  if (StatisticBits < 8 || StatisticBits > 32) begin : gen_check_statistic_bits
    $fatal(1, "msn_packet: StatisticBits = %0d must lie in 8 .. 32", StatisticBits);
  end
  if (Taxels == 1 || Taxels > 65536) begin : gen_check_taxels
    $fatal(1, "msn_packet: Taxels = %0d must be 0 or lie in 2 .. 65536", Taxels);
  end
  if (Chunk < 1 || Chunk > 116) begin : gen_check_chunk
    $fatal(1, "msn_packet: Chunk = %0d must lie in 1 .. 116: a packet has 253 bytes at most", Chunk);
  end

  // A record: type, bytes of payload, time, payload, first byte lowest.
  localparam int unsigned PayloadBits = 96;
  localparam int unsigned RecordBits  = 8 + 4 + 48 + PayloadBits;

  logic slip_valid, class_valid, cop_valid, health_valid, statistic_valid, image_valid;
  logic slip_take, class_take, cop_take, health_take, statistic_take, image_take, states_valid, states_take;
  logic [RecordBits-1:0] slip, classes, cop, health, answer, statistic, image, states;

  logic slip_start;  // the change that waits starts a slip
  if (SlipDepth > 0) begin : gen_slip
    logic             half;
    msn_pkg::change_t change;
    logic [47:0]      change_time;
    logic [4:0]       past;
    msn_fifo #(.Depth(SlipDepth), .Width(96)) u_queue (
      .clk_i, .rst_i,
      .in_valid_i(slip_valid_i), .in_ready_o(slip_ready_o), .in_data_i({slip_i, slip_time_i}),
      .out_valid_o(slip_valid), .out_ready_i(slip_take), .out_data_o({change, change_time}), .half_o(half)
    );
    assign slip_room_o = !half;
    assign slip_start  = change.start;
    assign past        = change.start ? '0 : {change.late, change.told, 1'b0};
    assign slip = {PayloadBits'({past, change.state, change.p2p, change.id}), change_time, 4'd6,
                   change.start ? 8'd1 : 8'd6};
  end else begin : gen_no_slip
    assign {slip_ready_o, slip_room_o, slip_valid, slip_start, slip} = '0;
    logic unused_slip;
    assign unused_slip = ^{slip_valid_i, slip_take};
  end

  if (Classes) begin : gen_class
    assign class_ready_o = !class_valid;
    always_ff @(posedge clk_i) begin
      class_valid <= (class_valid_i && class_ready_o) || (class_valid && !class_take);
      if (class_ready_o) begin
        classes <= {PayloadBits'({class_i.votes, class_i.told, class_i.label}), class_i.stamp, 4'd8, 8'd8};
      end
      if (rst_i) class_valid <= 1'b0;
    end
  end else begin : gen_no_class
    assign {class_ready_o, class_valid, classes} = '0;
    logic unused_class;
    assign unused_class = ^{class_valid_i, class_i, class_take};
  end

  if (Cop) begin : gen_cop
    always_ff @(posedge clk_i) begin
      cop_valid <= cop_valid_i || (cop_valid && !cop_take);
      if (cop_valid_i) begin
        cop <= {PayloadBits'({7'd0, cop_i.pressed, cop_i.load, cop_i.y, cop_i.x}), cop_time_i, 4'd12, 8'd2};
      end
      if (cop_valid_i && cop_valid && !cop_take) cop_dropped_o <= cop_dropped_o + 1'b1;
      if (rst_i) begin
        cop_valid     <= 1'b0;
        cop_dropped_o <= '0;
      end
    end
  end else begin : gen_no_cop
    assign {cop_valid, cop, cop_dropped_o} = '0;
    logic unused_cop;
    assign unused_cop = ^{cop_valid_i, cop_take};
  end

  if (Health) begin : gen_health
    assign health_ready_o = !health_valid;
    always_ff @(posedge clk_i) begin
      health_valid <= (health_valid_i && health_ready_o) || (health_valid && !health_take);
      if (health_ready_o) health <= {PayloadBits'({health_i.faults, health_i.id}), now_i, 4'd4, 8'd4};
      if (rst_i) health_valid <= 1'b0;
    end
  end else begin : gen_no_health
    assign {health_ready_o, health_valid, health} = '0;
    logic unused_health;
    assign unused_health = ^{health_valid_i, health_take};
  end

  logic answer_valid;
  assign answer_valid = Answers && answer_valid_i;
  assign answer       = {PayloadBits'(answer_data_i), now_i, 4'd8, 8'd16};

  if (Statistics > 0) begin : gen_statistics
    logic [StatisticBits-1:0] wait_clocks;
    logic [7:0]               index;
    logic [31:0]              counter;
    always_ff @(posedge clk_i) begin
      wait_clocks     <= wait_clocks + 1'b1;
      statistic_valid <= (&wait_clocks) || (statistic_valid && !statistic_take);
      counter         <= statistics_i[32*index[msn_pkg::index_width(Statistics)-1:0]+:32];
      if (statistic_take) index <= (index >= 8'(Statistics - 1)) ? '0 : index + 1'b1;
      if (rst_i) begin
        wait_clocks     <= '0;
        statistic_valid <= 1'b0;
        index           <= '0;
      end
    end
    assign statistic = {PayloadBits'({counter, index}), now_i, 4'd5, 8'd5};
  end else begin : gen_no_statistics
    assign {statistic_valid, statistic} = '0;
    logic unused_statistics;
    assign unused_statistics = ^{statistics_i, statistic_take};
  end

  logic        states_step, states_end;
  logic [15:0] states_word;
  if (States > 0) begin : gen_states
    logic [15:0] first, remaining;
    msn_state_report #(.Channels(States), .First(FirstState)) u_report (
      .clk_i, .rst_i,
      .report_i(states_i), .read_id_o(states_id_o), .read_state_i(states_state_i),
      .chunk_valid_o(states_valid), .chunk_first_o(first), .chunk_left_o(remaining), .take_i(states_take),
      .word_o(states_word), .end_o(states_end), .step_i(states_step)
    );
    assign states = {PayloadBits'({remaining, first}), now_i, 4'd4, 8'd7};
  end else begin : gen_no_states
    assign {states_id_o, states_valid, states, states_end, states_word} = '0;
    logic unused_states;
    assign unused_states = ^{states_i, states_state_i, states_take, states_step};
  end

  logic        image_step;  // go to the next taxel
  logic        image_end;   // the present taxel is the packet's last
  logic [15:0] taxel;
  if (Taxels > 0) begin : gen_image
    logic [msn_pkg::index_width(Taxels)-1:0] first;
    logic [7:0]                              number;
    logic                                    final_chunk;
    logic [47:0]                             image_time;
    msn_image_chunks #(.Taxels(Taxels), .Chunk(Chunk)) u_chunks (
      .clk_i, .rst_i,
      .in_valid_i(image_valid_i), .in_data_i(image_data_i), .in_last_i(image_last_i),
      .in_time_i(image_time_i),
      .chunk_valid_o(image_valid), .chunk_time_o(image_time), .chunk_number_o(number),
      .chunk_first_o(first), .chunk_final_o(final_chunk), .take_i(image_take),
      .taxel_o(taxel), .end_o(image_end), .step_i(image_step),
      .dropped_o(image_dropped_o)
    );
    assign image = {PayloadBits'({24'(first), 7'd0, final_chunk, number}), image_time, 4'd5, 8'd3};
  end else begin : gen_no_image
    assign {image_valid, image, image_end, taxel, image_dropped_o} = '0;
    logic unused_image;
    assign unused_image = ^{image_valid_i, image_data_i, image_last_i, image_take, image_step};
  end

  logic unused_inputs;
  assign unused_inputs = ^{slip_i, slip_time_i, cop_i, cop_time_i, health_i, image_time_i};

  // Choose.
  typedef enum logic [1:0] {
    Idle,
    Record,
    Pixels,
    Check
  } state_e;
  state_e state;

  // The chosen source is registered and its record taken a clock later, because the record is wide.
  logic                  idle, some, others, yields;  // yields: changes do, to the others
  logic [2:0]            changes;                     // since a packet of an image
  logic [7:0]            waits, turn;  // the first of those that wait
  logic [RecordBits-1:0] chosen;
  assign idle  = state == Idle && !out_valid_o;
  assign waits = {image_valid, statistic_valid, health_valid, cop_valid, class_valid, states_valid,
                  answer_valid,
                  slip_valid && (slip_start || !((yields && others) || (&changes && image_valid)))};
  assign others = statistic_valid || health_valid || cop_valid || class_valid || states_valid || answer_valid;
  assign some  = |waits;
  assign {image_take, statistic_take, health_take, cop_take, class_take, states_take, answer_ready_o,
          slip_take} = turn;
  assign chosen = ({RecordBits{turn[0]}} & slip) | ({RecordBits{turn[1]}} & answer) |
                  ({RecordBits{turn[2]}} & states) | ({RecordBits{turn[3]}} & classes) |
                  ({RecordBits{turn[4]}} & cop) | ({RecordBits{turn[5]}} & health) |
                  ({RecordBits{turn[6]}} & statistic) | ({RecordBits{turn[7]}} & image);

  // Send: at most a byte every fourth clock, so that memory and checksum have settled.
  logic [63+PayloadBits:0] bytes;  // of the record, the next byte lowest
  logic [4:0]              left;   // of the record after this one, then of the checksum
  logic [1:0]              phase;
  logic                    pixels, of_states, upper, emit, section_end, words_end;
  logic [15:0]             word;  // a taxel, or four channels' states
  logic [31:0]             crc;
  logic [7:0]              crc_low;
  logic [23:0]             unused_crc;
  logic [7:0]              next;
  assign {unused_crc, crc_low} = crc;
  assign out_begin_o = slip_valid || state != Idle;  // for the others a clock later, for timing
  assign emit        = state != Idle && (&phase) && !out_valid_o;  // not out_ready_i, whose path is long
  assign next        = (state == Record) ? bytes[7:0] : (state == Pixels) ? (upper ? word[15:8] : word[7:0])
                                         : ~crc_low;
  assign word        = of_states ? states_word : taxel;
  assign words_end   = of_states ? states_end : image_end;
  assign section_end = (state == Pixels) ? upper && words_end : left == '0;
  assign image_step  = emit && state == Pixels && upper && !of_states;
  assign states_step = emit && state == Pixels && upper && of_states;

  always_ff @(posedge clk_i) begin
    if (out_ready_i) out_valid_o <= 1'b0;
    if (!(&phase) || emit) phase <= phase + 1'b1;
    if (emit) begin
      out_valid_o <= 1'b1;
      out_data_o  <= next;
      out_last_o  <= state == Check && section_end;
      upper       <= state == Pixels && !upper;
      bytes       <= bytes >> 8;
      left        <= section_end ? 5'd3 : left - 1'b1;
      if (section_end) state <= (state == Record && pixels) ? Pixels : (state == Check) ? Idle : Check;
    end
    turn <= idle ? waits & ('0 - waits) : '0;
    if (idle) begin
      phase <= '0;
      upper <= 1'b0;
      if (some) state <= Record;
    end
    if (|turn[7:1]) yields <= 1'b0;
    else if (turn[0] && !slip_start) yields <= 1'b1;
    if (turn[7]) changes <= '0;
    else if (turn[0] && !slip_start && !(&changes)) changes <= changes + 1'b1;
    if (|turn) begin
      bytes     <= {chosen[RecordBits-1:12], packets_o[7:0], chosen[7:0]};
      left      <= 5'd7 + 5'(chosen[11:8]);
      pixels    <= turn[7] || turn[2];
      of_states <= States > 0 && turn[2];
      packets_o <= packets_o + 1'b1;
    end
    if (rst_i) begin
      state       <= Idle;
      turn        <= '0;
      yields      <= 1'b0;
      changes     <= '0;
      out_valid_o <= 1'b0;
      packets_o   <= '0;
    end
  end

  msn_crc32 #(.Bits(8)) u_crc (
    .clk_i, .clear_i(idle), .step_i(emit), .in_data_i((state == Check) ? crc_low : next), .out_crc_o(crc)
  );

endmodule
