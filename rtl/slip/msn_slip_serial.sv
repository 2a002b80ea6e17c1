// SPDX-License-Identifier: Apache-2.0
//
// The whole slip path of one channel, a bit a clock: msn_frame_check, msn_haar, msn_peak_to_peak with tumbling
// windows and msn_slip, the same decisions bit for bit, for the smallest builds. Two passes over a sample's bits,
// lowest first; bit i of every variable is a column of word i of one small memory.
//
//   pass 1   d = even - odd, a = even + odd; compare d with the window's extremes, a with the levels; the timer
//   pass 2   new extremes, p2p = max d - min d; compare p2p with the thresholds; keep the sample
//   then     step the state, take the sample
//
// A sample is taken (in_ready_o) 2*Steps + 1 clocks after it is first offered, with actuator_moving_i of that
// clock; the decision follows one clock later. Steps: the power of two that holds a detail and a timer's sign.
// Model: model/meissner/slip/slip_serial.py

module msn_slip_serial #(
  parameter  int unsigned SampleBits = 17,
  parameter  int unsigned Level      = 1,
  parameter  int unsigned Window     = 64,  // samples
  parameter  int unsigned TimerBits  = 14,
  localparam int unsigned DetailBits = SampleBits + Level
) (
  input  logic                         clk_i,
  input  logic                         rst_i,

  input  logic        [DetailBits-1:0] cfg_threshold_i,
  input  logic        [DetailBits-1:0] cfg_gross_threshold_i,
  input  logic signed [DetailBits-1:0] cfg_contact_level_i,
  input  logic signed [DetailBits-1:0] cfg_release_level_i,
  input  logic                         cfg_contact_rises_i,  // pressing raises the level
  input  logic        [TimerBits-1:0]  cfg_hold_i,
  input  logic        [TimerBits-1:0]  cfg_refractory_i,
  input  logic        [TimerBits-1:0]  cfg_blank_i,
  input  logic                         actuator_moving_i,

  input  logic                         in_valid_i,
  output logic                         in_ready_o,
  input  logic signed [SampleBits-1:0] in_data_i,
  input  logic                         in_id_i,
  input  logic                         in_last_i,

  output logic                         out_valid_o,
  input  logic                         out_ready_i,
  output logic        [2:0]            out_state_o,  // msn_pkg::slip_state_e
  output logic                         out_raised_o,
  output logic                         out_over_o,
  output logic        [DetailBits-1:0] out_p2p_o,
  output logic                         out_end_o,

  output logic        [31:0]           damaged_o,    // samples without `last`, and what follows them
  output logic        [31:0]           blanked_o     // details that were over while blanked or moving
);

  localparam int unsigned CountBits = TimerBits + 1;
  localparam int unsigned StepBits  = $clog2((DetailBits > CountBits) ? DetailBits : CountBits);
  localparam int unsigned Steps     = 1 << StepBits;
  localparam int unsigned PlaceBits = $clog2(Window >> Level);

  if (SampleBits < 2) begin : gen_check_sample_bits
    $fatal(1, "msn_slip_serial: SampleBits = %0d must be at least 2", SampleBits);
  end
  if (Level < 1 || Level > 3) begin : gen_check_level
    $fatal(1, "msn_slip_serial: Level = %0d must be 1, 2 or 3", Level);
  end
  if (Window < (2 << Level) || (Window & (Window - 1)) != 0) begin : gen_check_window
    $fatal(1, "msn_slip_serial: Window = %0d must be a power of two, %0d or more", Window, 2 << Level);
  end
  if (TimerBits < 1 || TimerBits > 31) begin : gen_check_timer_bits
    $fatal(1, "msn_slip_serial: TimerBits = %0d must lie in 1 .. 31", TimerBits);
  end

  // A sample without `last` or of another channel is taken at once, and so is all up to the next `last`.
  logic dropping, keep, forget;
  assign keep   = in_last_i && !in_id_i && !dropping;
  assign forget = in_valid_i && in_ready_o && !keep;

  // The address that is read runs a clock ahead of the bit that is worked on; its two top bits: pass 2, end.
  logic [StepBits+1:0] ahead, at;
  logic                run, start, finish, second, top;
  assign start      = in_valid_i && keep && !run && !out_valid_o;
  assign finish     = run && at[StepBits+1];
  assign second     = at[StepBits];
  assign top        = &at[StepBits-1:0];
  assign in_ready_o = finish || (!run && !out_valid_o && !keep);

  always_ff @(posedge clk_i) begin
    at    <= ahead;
    ahead <= ((run || start) && !finish) ? ahead + 1'b1 : '0;
    run   <= start || (run && !finish);
    if (in_valid_i && in_ready_o) dropping <= !in_last_i && !keep;
    if (rst_i) begin
      ahead    <= '0;
      run      <= 1'b0;
      dropping <= 1'b0;
    end
  end

  // Which sample of its group this is, and which detail of its window.
  logic [Level-1:0]     member;
  logic [PlaceBits-1:0] place;
  logic                 complete, first;
  assign complete = &member;
  assign first    = place == '0;
  always_ff @(posedge clk_i) begin
    if (finish) member <= member + 1'b1;
    if (finish && complete) place <= place + 1'b1;
    if (forget || rst_i) begin
      member <= '0;
      place  <= '0;
    end
  end

  // The columns: of each level the value before, the window's maximum and minimum, the timer.
  (* no_rw_check, ram_style = "block" *) logic [Level+2:0] memory [Steps];
  logic [Level+2:0] word, next_word, write;
  always_ff @(posedge clk_i) word <= memory[ahead[StepBits-1:0]];
  for (genvar column = 0; column < Level + 3; column++) begin : gen_column
    always_ff @(posedge clk_i) begin
      if (write[column]) memory[at[StepBits-1:0]][column] <= next_word[column];
    end
  end

  // The present bit of what comes in from outside.
  logic sample, threshold, gross_threshold, contact_level, release_level;
  logic [Steps-1:0] samples, thresholds, gross_thresholds, contact_levels, release_levels;
  assign samples          = Steps'(in_data_i);
  assign thresholds       = Steps'(cfg_threshold_i);
  assign gross_thresholds = Steps'(cfg_gross_threshold_i);
  assign contact_levels   = Steps'(cfg_contact_level_i);
  assign release_levels   = Steps'(cfg_release_level_i);
  assign sample           = samples[at[StepBits-1:0]];
  assign threshold        = thresholds[at[StepBits-1:0]];
  assign gross_threshold  = gross_thresholds[at[StepBits-1:0]];
  assign contact_level    = contact_levels[at[StepBits-1:0]];
  assign release_level    = release_levels[at[StepBits-1:0]];

  // The Haar levels. A level keeps what came before whenever all levels below it have a value.
  logic restart;
  assign restart = !run || top;
  for (genvar l = 0; l < Level; l++) begin : gen_level
    logic now, kept, sum, carry;
    if (l == 0) begin : gen_sample
      assign now = sample;
    end else begin : gen_total
      assign now = gen_level[l-1].sum;
    end
    assign kept         = word[l];
    assign sum          = kept ^ now ^ carry;
    assign next_word[l] = now;
    assign write[l]     = run && second && &(member | ~((Level)'((1 << l) - 1)));
    always_ff @(posedge clk_i) carry <= !restart && ((kept && now) || (carry && (kept || now)));
  end
  logic even, odd, total, detail, detail_borrow;
  assign even   = gen_level[Level-1].kept;
  assign odd    = gen_level[Level-1].now;
  assign total  = gen_level[Level-1].sum;
  assign detail = even ^ odd ^ detail_borrow;
  always_ff @(posedge clk_i) begin
    detail_borrow <= !restart && ((!even && odd) || (detail_borrow && (!even || odd)));
  end

  // Pass 1: comparisons of signed numbers. Where they differ, the higher bit decides; at the sign, the other way.
  logic high, low, higher, lower, beyond_contact, beyond_release;
  logic contact_great, contact_less, release_great, release_less;
  assign high          = word[Level];
  assign low           = word[Level+1];
  assign contact_great = cfg_contact_rises_i ? contact_level : total;  // pressed unless great > less
  assign contact_less  = cfg_contact_rises_i ? total : contact_level;
  assign release_great = cfg_contact_rises_i ? release_level : total;  // lifted if great > less
  assign release_less  = cfg_contact_rises_i ? total : release_level;
  always_ff @(posedge clk_i) begin
    if (!second) begin
      if (detail != high) higher <= detail ^ top;
      if (detail != low)  lower  <= low ^ top;
      if (contact_great != contact_less) beyond_contact <= contact_great ^ top;
      if (release_great != release_less) beyond_release <= release_great ^ top;
    end
    if (!run) begin
      higher         <= 1'b0;
      lower          <= 1'b0;
      beyond_contact <= 1'b0;
      beyond_release <= 1'b0;
    end
  end

  // Pass 2: the window's extremes, their difference, and the thresholds.
  logic new_high, new_low, p2p, p2p_borrow, over, gross;
  assign new_high           = (first || higher) ? detail : high;
  assign new_low            = (first || lower) ? detail : low;
  assign next_word[Level]   = new_high;
  assign next_word[Level+1] = new_low;
  assign write[Level]       = run && second && complete;
  assign write[Level+1]     = run && second && complete;
  assign p2p                = new_high ^ new_low ^ p2p_borrow;
  always_ff @(posedge clk_i) begin
    p2p_borrow <= !restart && ((!new_high && new_low) || (p2p_borrow && (!new_high || new_low)));
    if (p2p != threshold)       over  <= p2p;
    if (p2p != gross_threshold) gross <= p2p;
    if (!second && !at[StepBits+1]) begin
      over  <= 1'b0;
      gross <= 1'b0;
    end
  end

  // The timer counts up from minus a register's value, so that "still running" is its sign. At each detail it
  // takes the step that the detail before asked for; only one time runs in any state, so one timer does.
  typedef enum logic [1:0] {
    Tick,
    LoadHold,
    LoadRefractory,
    LoadBlank
  } timer_step_e;
  timer_step_e timer_step_q, timer_step_d;
  logic        running, tick_carry, count, next_count;
  logic        [Steps-1:0] holds, refractories, blanks;
  assign holds        = '0 - Steps'(cfg_hold_i);
  assign refractories = '0 - Steps'(cfg_refractory_i);
  assign blanks       = '0 - Steps'(cfg_blank_i);
  assign count        = word[Level+2];
  always_comb begin
    case (timer_step_q)
      LoadHold:       next_count = holds[at[StepBits-1:0]];
      LoadRefractory: next_count = refractories[at[StepBits-1:0]];
      LoadBlank:      next_count = blanks[at[StepBits-1:0]];
      default:        next_count = count ^ tick_carry;
    endcase
  end
  assign next_word[Level+2] = next_count;
  assign write[Level+2]     = run && complete && !second && !finish;
  always_ff @(posedge clk_i) begin
    tick_carry <= run ? (tick_carry && count) : running;
    if (complete && top && !second) running <= next_count;
  end

  // The state, as in msn_slip.
  logic [2:0] next_state;
  logic       blanking, next_blanking, was_slipping, touching, pressed, lifted, counts;
  assign was_slipping = out_state_o == msn_pkg::Incipient || out_state_o == msn_pkg::Gross;
  assign touching     = out_state_o == msn_pkg::Contact || was_slipping;
  assign pressed      = !beyond_contact;
  assign lifted       = beyond_release;

  always_comb begin
    next_state    = out_state_o;
    next_blanking = blanking;
    timer_step_d  = Tick;
    counts        = 1'b0;
    if (touching && lifted) begin
      next_state   = msn_pkg::Release;
      timer_step_d = LoadHold;
    end else if (was_slipping) begin
      counts = over && actuator_moving_i;
      if (over && !actuator_moving_i) begin
        timer_step_d = LoadHold;
        if (gross) next_state = msn_pkg::Gross;
      end else if (!running) begin
        next_state    = msn_pkg::Contact;
        timer_step_d  = LoadRefractory;
        next_blanking = 1'b0;
      end
    end else if (touching) begin
      counts = over && (actuator_moving_i || (blanking && running));
      if (over && !actuator_moving_i && !running) begin
        next_state   = gross ? msn_pkg::Gross : msn_pkg::Incipient;
        timer_step_d = LoadHold;
      end
    end else if (pressed) begin
      next_state    = msn_pkg::Contact;
      timer_step_d  = LoadBlank;
      next_blanking = 1'b1;
    end else if (!(out_state_o == msn_pkg::Release && running)) begin
      next_state = msn_pkg::None;
    end
  end

  logic             slipping;
  logic [Steps-1:0] p2p_q;
  assign out_p2p_o = p2p_q[DetailBits-1:0];
  assign slipping = next_state == msn_pkg::Incipient || next_state == msn_pkg::Gross;

  always_ff @(posedge clk_i) begin
    if (second) p2p_q <= {p2p, p2p_q[Steps-1:1]};
    out_valid_o <= (finish && complete) || (out_valid_o && !out_ready_i);
    if (finish && complete) begin
      out_state_o  <= next_state;
      out_raised_o <= slipping && !was_slipping;
      out_over_o   <= over;
      out_end_o    <= &place;
      timer_step_q <= timer_step_d;
      blanking     <= next_blanking;
      if (counts) blanked_o <= blanked_o + 1'b1;
    end
    if (forget) out_state_o <= msn_pkg::None;
    if (forget && !dropping) damaged_o <= damaged_o + 1'b1;
    if (rst_i) begin
      out_valid_o <= 1'b0;
      out_state_o <= msn_pkg::None;
      damaged_o   <= '0;
      blanked_o   <= '0;
    end
  end

endmodule
