// SPDX-License-Identifier: Apache-2.0
//
// Controller of an SDR SDRAM of 16 bits that only reads words of 64 bits, in bursts of four, and loads them.
//
//   word address = {bank [21:20], row [19:7], column / 4 [6:0]}     four beats of 16 bits, the low one first
//
// Each bank has a queue of reads; a row is opened for each read and closes itself, so that while one bank answers the
// other three open and close: four clocks a read. Answers of a bank come in order, those of two banks as they come; a
// tag names each. A load waits until no row is open; so does a refresh. Loads and reads take turns if both wait.
// The times in clocks follow from those that suit all four parts, ClkKhz and PowerUpUs (docs/sdram.md). Pins leave from
// and arrive in registers; the part's clock is clk_i inverted. A reset loses what the memory holds.
//
// Latency: ReadClocks + 12 clocks at 100 MHz for a read that finds its bank closed, one read in four clocks.
// Model: model/meissner/twins/forest/sdram.py
// Error: none.

module msn_sdram #(
  parameter int unsigned ClkKhz     = 100_000,
  parameter int unsigned PowerUpUs  = 200,  // less only in simulation
  parameter int unsigned TagBits    = 5,
  parameter int unsigned Queue      = 32,   // of each bank; as many as are in flight: none makes others wait
  parameter int unsigned ReadClocks = 4     // from a command's edge to that of its first beat; CAS latency 3
) (
  input  logic               clk_i,
  input  logic               rst_i,

  input  logic               req_valid_i,
  output logic               req_ready_o,
  input  logic [21:0]        req_address_i,
  input  logic [TagBits-1:0] req_tag_i,

  output logic               rsp_valid_o,
  output logic [TagBits-1:0] rsp_tag_o,
  output logic [63:0]        rsp_data_o,

  input  logic               load_valid_i,
  output logic               load_ready_o,
  input  logic [21:0]        load_address_i,
  input  logic [63:0]        load_data_i,

  output logic               up_o,          // the part is set up

  output logic               sdram_cke_o,
  output logic               sdram_cs_n_o,
  output logic               sdram_ras_n_o,
  output logic               sdram_cas_n_o,
  output logic               sdram_we_n_o,
  output logic [1:0]         sdram_ba_o,
  output logic [12:0]        sdram_a_o,
  output logic [1:0]         sdram_dqm_o,
  output logic [15:0]        sdram_dq_o,
  output logic               sdram_dq_enable_o,
  input  logic [15:0]        sdram_dq_i
);

  if (ClkKhz < 20_000 || ClkKhz > 133_000) begin : gen_check_clk
    $fatal(1, "msn_sdram: ClkKhz = %0d must lie in 20000 .. 133000", ClkKhz);
  end
  if (PowerUpUs < 1 || PowerUpUs > 1000) begin : gen_check_power_up
    $fatal(1, "msn_sdram: PowerUpUs = %0d must lie in 1 .. 1000", PowerUpUs);
  end
  if (TagBits < 1 || TagBits > 16) begin : gen_check_tag_bits
    $fatal(1, "msn_sdram: TagBits = %0d must lie in 1 .. 16", TagBits);
  end
  if (ReadClocks < 3 || ReadClocks > 6) begin : gen_check_read_clocks
    $fatal(1, "msn_sdram: ReadClocks = %0d must lie in 3 .. 6", ReadClocks);
  end

  // ns, of the slowest of the parts. Their row cycle and their least time of an open row follow up to 133 MHz:
  // a row is open for Rcd + Burst clocks.
  localparam int unsigned Burst   = 4;
  localparam int unsigned Rcd     = msn_pkg::clocks_of_ns(21, ClkKhz);
  localparam int unsigned Rp      = msn_pkg::clocks_of_ns(21, ClkKhz);
  localparam int unsigned Rrd     = msn_pkg::clocks_of_ns(15, ClkKhz);
  localparam int unsigned Rfc     = msn_pkg::clocks_of_ns(70, ClkKhz);
  localparam int unsigned Wr      = msn_pkg::clocks_of_ns(20, ClkKhz);
  localparam int unsigned Mrd     = Rrd > 2 ? Rrd : 2;
  localparam int unsigned PowerUp = PowerUpUs * ClkKhz / 1000 + 1;
  localparam int unsigned Refresh = ClkKhz * 125 / 16_000 - 1;  // 8192 in less than 64 ms, however late each
  localparam int unsigned Refreshes = 8;   // before the mode is set
  localparam int unsigned Turn      = 64;  // clocks for reads between two loads
  localparam int unsigned WaitBits    = $clog2(PowerUp + 1);
  localparam int unsigned RefreshBits = $clog2(Refresh);
  localparam int unsigned RestBits    = 12;

  function automatic logic [RestBits-1:0] ones(int unsigned count);
    ones = RestBits'((32'd1 << count) - 32'd1);
  endfunction

  // RAS, CAS, WE; a deselected part ignores all three.
  typedef enum logic [2:0] {Mode, AutoRefresh, Precharge, Activate, Write, Read, Stop, Nop} command_e;
  localparam logic [12:0] ModeWord = 13'h032;  // bursts of four, in order; CAS latency 3
  localparam logic [12:0] AllBanks = 13'h400;

  // The queues.
  logic [3:0]              queue_ready, queue_valid, queue_take;
  logic [3:0][19:0]        queue_place;
  logic [3:0][TagBits-1:0] queue_tag;
  assign req_ready_o = queue_ready == '1;
  for (genvar bank = 0; bank < 4; bank++) begin : gen_queue
    logic put, unused_half;
    assign put = req_valid_i && req_ready_o && req_address_i[21:20] == 2'(bank);
    msn_fifo #(.Depth(Queue), .Width(20 + TagBits)) u_queue (
      .clk_i, .rst_i,
      .in_valid_i(put), .in_ready_o(queue_ready[bank]), .in_data_i({req_tag_i, req_address_i[19:0]}),
      .out_valid_o(queue_valid[bank]), .out_ready_i(queue_take[bank]),
      .out_data_o({queue_tag[bank], queue_place[bank]}), .half_o(unused_half)
    );
  end

  // Setting up: the wait, all rows closed, refreshes, the mode.
  typedef enum logic [2:0] {Power, Refreshing, Set, Settle, Up} state_e;
  state_e              state;
  logic [WaitBits-1:0] pause;
  logic [3:0]          refreshed;
  logic                next;
  assign next = pause == '0 && state != Up;
  assign up_o = state == Up;

  // Decided in the clock before.
  logic       sets, refreshes, load_opens, writes;
  logic [3:0] opens, reads;
  state_e     sets_state;

  // A bank is idle, or open until its read. `rest`: a bit for each clock until it may go on. What it can do in the next
  // clock is known in this one, so that the choice begins from registers.
  logic [3:0]               open, can_open, can_read;
  logic [3:0][RestBits-1:0] rest;
  logic [RestBits-1:0]      open_rest, burst_rest;  // since a row of any bank was opened, since a read
  logic [3:0]               rested;
  for (genvar bank = 0; bank < 4; bank++) begin : gen_bank
    assign rested[bank] = !rest[bank][0];
  end

  // What waits until no row is open: a refresh, then a load; loads and reads take turns if both wait.
  logic [RefreshBits-1:0] refresh_count;
  logic [6:0]             load_rest;
  logic                   refresh_due, load_due, closed, hold, loading, writing;
  logic [1:0]             beat;
  assign hold   = refresh_due || load_due || loading || !up_o;
  assign closed = up_o && open == '0 && rested == '1 && !loading;

  logic refresh, load_open, load_write, activate, read;
  assign refresh    = closed && refresh_due;
  assign load_open  = closed && !refresh_due && load_due;
  assign load_write = loading && !writing && !writes && rested[0];
  assign read       = can_read != '0 && !burst_rest[0];
  assign activate   = can_open != '0 && !open_rest[0] && !hold && !read;

  // The lowest bank of those in `after`, else the lowest.
  function automatic logic [3:0] lowest(logic [3:0] x);
    lowest = {x[3] && x[2:0] == '0, x[2] && x[1:0] == '0, x[1] && !x[0], x[0]};
  endfunction
  function automatic logic [3:0] above(logic [2:0] one);
    above = {one != '0, one[1:0] != '0, one[0], 1'b0};
  endfunction
  logic [3:0] open_after, read_after, open_pick, read_pick, opens_bank, reads_bank;
  assign open_pick  = lowest((can_open & open_after) != '0 ? can_open & open_after : can_open);
  assign read_pick  = lowest((can_read & read_after) != '0 ? can_read & read_after : can_read);
  assign opens_bank = activate ? open_pick : '0;
  assign reads_bank = read ? read_pick : '0;

  always_ff @(posedge clk_i) begin
    if (pause != '0) pause <= pause - 1'b1;
    if (next) begin
      case (state)
        Power: begin
          state <= Refreshing;
          pause <= WaitBits'(Rp - 1);
        end
        Refreshing: begin
          if (refreshed == 4'(Refreshes - 1)) state <= Set;
          refreshed <= refreshed + 1'b1;
          pause     <= WaitBits'(Rfc - 1);
        end
        Set: begin
          state <= Settle;
          pause <= WaitBits'(Mrd - 1);
        end
        default: state <= Up;
      endcase
    end

    refresh_count <= refresh_count == '0 ? RefreshBits'(Refresh - 1) : refresh_count - 1'b1;
    refresh_due   <= up_o && (refresh_count == '0 || (refresh_due && !refresh));

    for (int unsigned each = 0; each < 4; each++) begin
      rest[each] <= rest[each] >> 1;
      if (refresh) rest[each] <= ones(Rfc - 1);
      if (load_open || opens_bank[each]) rest[each] <= ones(Rcd - 1);
      if (load_write) rest[each] <= ones(Burst - 1 + Wr + Rp - 1);
      if (reads_bank[each]) rest[each] <= ones(Burst + Rp - 1);
      can_open[each] <= queue_valid[each] && !open[each] && !rest[each][1] && !opens_bank[each] && !refresh;
      can_read[each] <= open[each] && !rest[each][1] && !reads_bank[each];
    end
    open       <= (open | opens_bank) & ~reads_bank;
    open_rest  <= activate ? ones(Rrd - 1) : open_rest >> 1;
    burst_rest <= read ? ones(Burst - 1) : burst_rest >> 1;
    if (activate) open_after <= above(open_pick[2:0]);
    if (read) read_after <= above(read_pick[2:0]);

    if (load_open) loading <= 1'b1;
    if (writes) writing <= 1'b1;
    if (load_ready_o) {loading, writing} <= '0;
    beat      <= writes || writing ? beat + 1'b1 : '0;
    load_rest <= load_ready_o ? 7'(Turn) : load_rest == '0 ? '0 : load_rest - 1'b1;
    load_due  <= load_valid_i && !loading && !load_open && (load_rest == '0 || queue_valid == '0);

    if (rst_i) begin
      state         <= Power;
      pause         <= WaitBits'(PowerUp);
      refreshed     <= '0;
      refresh_count <= RefreshBits'(Refresh - 1);
      refresh_due   <= 1'b0;
      rest          <= '0;
      open          <= '0;
      can_open      <= '0;
      can_read      <= '0;
      open_after    <= '0;
      read_after    <= '0;
      open_rest     <= '0;
      burst_rest    <= '0;
      loading       <= 1'b0;
      writing       <= 1'b0;
      beat          <= '0;
      load_rest     <= '0;
      load_due      <= 1'b0;
    end
  end
  assign load_ready_o = writing && beat == 2'd3;

  // A clock later: the command and its address. A read takes its entry from the queue, and a row is opened for the
  // entry that is next.
  always_ff @(posedge clk_i) begin
    sets_state <= state;
    sets       <= next;
    refreshes  <= refresh;
    load_opens <= load_open;
    writes     <= load_write;
    opens      <= opens_bank;
    reads      <= reads_bank;
    if (rst_i) {sets, refreshes, load_opens, writes, opens, reads} <= '0;
  end
  assign queue_take = reads;

  logic [19:0]        place;  // of the bank that reads or opens
  logic [TagBits-1:0] tag;
  logic [1:0]         bank;
  always_comb begin
    place = '0;
    tag   = '0;
    for (int unsigned each = 0; each < 4; each++) begin
      place |= {20{opens[each] || reads[each]}} & queue_place[each];
      tag   |= {TagBits{reads[each]}} & queue_tag[each];
    end
    bank = {opens[3] || reads[3] || opens[2] || reads[2], opens[3] || reads[3] || opens[1] || reads[1]};
  end

  // The pins. Data are enabled in the clocks of a written burst only.
  command_e    command;
  logic        loads;
  logic [19:0] where;
  assign loads = load_opens || writes;
  assign where = loads ? load_address_i[19:0] : place;
  always_comb begin
    command = Nop;
    if (sets) begin
      case (sets_state)
        Power:      command = Precharge;
        Refreshing: command = AutoRefresh;
        Set:        command = Mode;
        default:    command = Nop;
      endcase
    end else if (refreshes) command = AutoRefresh;
    else if (load_opens || opens != '0) command = Activate;
    else if (writes) command = Write;
    else if (reads != '0) command = Read;
  end
  always_ff @(posedge clk_i) begin
    {sdram_ras_n_o, sdram_cas_n_o, sdram_we_n_o} <= command;
    sdram_cs_n_o      <= command == Nop;
    sdram_ba_o        <= sets ? '0 : loads ? load_address_i[21:20] : bank;
    sdram_a_o         <= sets ? (sets_state == Set ? ModeWord : AllBanks)
                         : load_opens || opens != '0 ? where[19:7] : {4'b0010, where[6:0], 2'b0};
    sdram_dq_o        <= load_data_i[16*beat+:16];
    sdram_dq_enable_o <= writes || writing;
    sdram_dqm_o       <= {2{!up_o}};
    sdram_cke_o       <= 1'b1;
    if (rst_i) begin
      sdram_cs_n_o      <= 1'b1;
      sdram_dq_enable_o <= 1'b0;
      sdram_dqm_o       <= '1;
      sdram_cke_o       <= 1'b0;
    end
  end

  // What was read: a beat arrives in each of four clocks. [k]: a read k clocks after its command reached the pins.
  localparam int unsigned Last = ReadClocks + Burst - 1;
  logic [Last:0]              reading;
  logic [Last:0][TagBits-1:0] reading_tag;
  logic [47:0]                earlier;
  logic [15:0]                arrived;
  always_ff @(posedge clk_i) begin
    arrived     <= sdram_dq_i;
    earlier     <= {arrived, earlier[47:16]};
    reading     <= {reading[Last-1:0], reads != '0};
    reading_tag <= {reading_tag[Last-1:0], tag};
    if (rst_i) reading <= '0;
  end
  assign rsp_valid_o = reading[Last];
  assign rsp_tag_o   = reading_tag[Last];
  assign rsp_data_o  = {arrived, earlier};

  msn_check u_load_stays_offered (.clk_i, .rst_i, .wrong_i(!rst_i && loading && !load_valid_i));

endmodule
