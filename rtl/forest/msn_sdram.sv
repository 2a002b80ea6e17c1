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
// Latency: ReadClocks + 10 clocks at 100 MHz for a read that finds its bank closed, one read in four clocks.
// Model: model/meissner/twins/forest/sdram.py
// Error: none.

module msn_sdram #(
  parameter int unsigned ClkKhz     = 100_000,
  parameter int unsigned PowerUpUs  = 200,  // less only in simulation
  parameter int unsigned TagBits    = 5,
  parameter int unsigned Queue      = 32,   // reads of each bank; as many as are in flight: no bank makes another wait
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

  // A bank is idle, or open until its read; `rest` counts the clocks until it may go on.
  logic [3:0]      open, rested, can_open, can_read;
  logic [3:0][3:0] rest;
  logic [1:0]      open_rest, burst_rest;  // since a row of any bank was opened, since a read
  for (genvar bank = 0; bank < 4; bank++) begin : gen_bank
    assign rested[bank] = rest[bank] == '0;
  end

  // What waits until no row is open: a refresh, then a load; loads and reads take turns.
  logic [RefreshBits-1:0] refresh_count;
  logic [6:0]             load_rest;
  logic                   refresh_due, load_due, closed, loading, writing;
  logic [1:0]             beat;
  assign load_due = load_valid_i && (load_rest == '0 || queue_valid == '0);
  assign closed   = up_o && open == '0 && rested == '1 && !loading;

  logic refresh, load_open, load_write, activate, read;
  assign refresh    = closed && refresh_due;
  assign load_open  = closed && !refresh_due && load_due;
  assign load_write = loading && !writing && rested == '1;
  assign can_read   = open & rested;
  assign read       = can_read != '0 && burst_rest == '0;
  assign can_open   = queue_valid & ~open & rested;
  assign activate   = up_o && can_open != '0 && open_rest == '0 && !read && !refresh_due && !load_due && !loading;

  // The first bank from `from` on.
  function automatic logic [1:0] pick(logic [3:0] banks, logic [1:0] from);
    pick = from;
    for (int unsigned step = 3; step >= 1; step--) if (banks[from + 2'(step)]) pick = from + 2'(step);
    if (banks[from]) pick = from;
  endfunction
  logic [1:0] open_from, read_from, open_bank, read_bank;
  assign open_bank  = pick(can_open, open_from);
  assign read_bank  = pick(can_read, read_from);
  assign queue_take = {3'b0, read} << read_bank;

  // The command, and to the pins in the next clock.
  command_e    command;
  logic [1:0]  bank;
  logic [12:0] address;
  always_comb begin
    command = Nop;
    bank    = load_address_i[21:20];
    address = load_address_i[19:7];
    if (next) begin
      case (state)
        Power:      command = Precharge;
        Refreshing: command = AutoRefresh;
        Set:        command = Mode;
        default:    command = Nop;
      endcase
      bank    = '0;
      address = state == Set ? ModeWord : AllBanks;
    end else if (refresh) command = AutoRefresh;
    else if (load_open) command = Activate;
    else if (load_write) begin
      command = Write;
      address = {2'b0, 1'b1, 1'b0, load_address_i[6:0], 2'b0};
    end else if (read) begin
      command = Read;
      bank    = read_bank;
      address = {2'b0, 1'b1, 1'b0, queue_place[read_bank][6:0], 2'b0};
    end else if (activate) begin
      command = Activate;
      bank    = open_bank;
      address = queue_place[open_bank][19:7];
    end
  end

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
      if (rest[each] != '0) rest[each] <= rest[each] - 1'b1;
      if (refresh) rest[each] <= 4'(Rfc - 1);
      if (load_open) rest[each] <= 4'(Rcd - 1);
      if (load_write) rest[each] <= 4'(Burst - 1 + Wr + Rp - 1);
    end
    if (activate) begin
      open[open_bank] <= 1'b1;
      rest[open_bank] <= 4'(Rcd - 1);
      open_from       <= open_bank + 1'b1;
    end
    if (read) begin
      open[read_bank] <= 1'b0;
      rest[read_bank] <= 4'(Burst + Rp - 1);
      read_from       <= read_bank + 1'b1;
    end
    open_rest  <= activate ? 2'(Rrd - 1) : open_rest == '0 ? '0 : open_rest - 1'b1;
    burst_rest <= read ? 2'(Burst - 1) : burst_rest == '0 ? '0 : burst_rest - 1'b1;

    if (load_open) loading <= 1'b1;
    if (load_write) writing <= 1'b1;
    if (load_ready_o) {loading, writing} <= '0;
    beat      <= load_write || writing ? beat + 1'b1 : '0;
    load_rest <= load_ready_o ? 7'(Turn) : load_rest == '0 ? '0 : load_rest - 1'b1;

    if (rst_i) begin
      state         <= Power;
      pause         <= WaitBits'(PowerUp);
      refreshed     <= '0;
      refresh_count <= RefreshBits'(Refresh - 1);
      refresh_due   <= 1'b0;
      rest          <= '0;
      open          <= '0;
      open_from     <= '0;
      read_from     <= '0;
      open_rest     <= '0;
      burst_rest    <= '0;
      loading       <= 1'b0;
      writing       <= 1'b0;
      beat          <= '0;
      load_rest     <= '0;
    end
  end
  assign load_ready_o = writing && beat == 2'd3;

  // The pins. Data are enabled in the clocks of a written burst only.
  always_ff @(posedge clk_i) begin
    {sdram_ras_n_o, sdram_cas_n_o, sdram_we_n_o} <= command;
    sdram_cs_n_o      <= command == Nop;
    sdram_ba_o        <= bank;
    sdram_a_o         <= address;
    sdram_dq_o        <= load_data_i[16*beat+:16];
    sdram_dq_enable_o <= load_write || writing;
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
    reading     <= {reading[Last-1:0], read};
    reading_tag <= {reading_tag[Last-1:0], queue_tag[read_bank]};
    if (rst_i) reading <= '0;
  end
  assign rsp_valid_o = reading[Last];
  assign rsp_tag_o   = reading_tag[Last];
  assign rsp_data_o  = {arrived, earlier};

  msn_check u_load_stays_offered (.clk_i, .rst_i, .wrong_i(!rst_i && loading && !load_valid_i));

endmodule
