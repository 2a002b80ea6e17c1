// SPDX-License-Identifier: Apache-2.0
//
// Subtracts each taxel's own zero b from its samples; measures b by averaging, and tracks it while nothing presses.
//
//   r = raw - o   o = floor(b + 1/2), saturated to a sample's bits   contact = r > contact   b in 2^-FractionBits
//   each frame, not in contact: b += sign(r) step                   frozen in contact
//   on average:    b += (sum of r over the next 2^TareLog2 frames) / 2^TareLog2, exact, for all taxels in the
//   same frame; refused without any change if a taxel that is not masked is in contact in these frames
//
// force: never refuse. start_i, once after a reset, when no zero is known: with at_start as average and force
// together. While load, frames are dropped and zeros can be written, but not to words that do not exist. After a reset all zeros are 0. A damaged frame restarts an averaging. Beats as
// msn_frame_marker gives them; a beat that does not fit leaves as 0, because in too long a frame its zeros were
// written by the same frame.
//
//   clock  1        2           3            4
//          raw - o  sign, sums  b, sum next  write
//
// Latency 1 clock; a beat a clock, 8 clocks between frames.   Model: model/meissner/twins/frontend/tare.py
// Error: none.

module msn_tare #(
  parameter  int unsigned Rows         = 64,
  parameter  int unsigned Columns      = 64,
  parameter  int unsigned Lanes        = 1,
  parameter  int unsigned SampleBits   = 17,
  parameter  int unsigned FractionBits = 12,
  parameter  int unsigned TareLog2     = 4,
  localparam int unsigned RowBeats     = (Columns + Lanes - 1) / Lanes,
  localparam int unsigned Beats        = Rows * RowBeats,
  localparam int unsigned IdBits       = msn_pkg::index_width(Beats),
  localparam int unsigned DiffBits     = SampleBits + 1
) (
  input  logic                        clk_i,
  input  logic                        rst_i,

  input  msn_registers_pkg::tare_cfg_t    cfg_i,      // step in 2^-FractionBits codes
  input  logic                            start_i,
  output msn_registers_pkg::tare_status_t status_o,   // pressed: in the last undamaged frame

  input  logic                        in_valid_i,
  output logic                        in_ready_o,
  input  logic [Lanes*SampleBits-1:0] in_data_i,      // signed
  input  logic [Lanes-1:0]            in_mask_i,      // taxels that cannot be trusted
  input  logic [IdBits-1:0]           in_id_i,        // its place
  input  logic                        in_fits_i,
  input  logic                        in_row_last_i,
  input  logic                        in_last_i,

  output logic                        out_valid_o,
  input  logic                        out_ready_i,
  output logic [Lanes*DiffBits-1:0]   out_data_o,     // r, signed
  output logic [Lanes-1:0]            out_mask_o,
  output logic [IdBits-1:0]           out_id_o,
  output logic                        out_fits_o,
  output logic                        out_row_last_o,
  output logic                        out_last_o
);

  localparam int unsigned ZeroBits = DiffBits + FractionBits;  // b
  localparam int unsigned SumBits  = DiffBits + TareLog2;      // of r
  localparam int unsigned PartBits = ZeroBits + SumBits;

  if (!msn_pkg::is_side(Rows)) begin : gen_check_rows
    $fatal(1, "msn_tare: Rows = %0d must lie in 1 .. 1024", Rows);
  end
  if (!msn_pkg::is_side(Columns)) begin : gen_check_columns
    $fatal(1, "msn_tare: Columns = %0d must lie in 1 .. 1024", Columns);
  end
  if (!msn_pkg::are_lanes(Lanes)) begin : gen_check_lanes
    $fatal(1, "msn_tare: Lanes = %0d must lie in 1 .. 8", Lanes);
  end
  if (FractionBits < 1 || FractionBits > 16) begin : gen_check_fraction_bits
    $fatal(1, "msn_tare: FractionBits = %0d must lie in 1 .. 16", FractionBits);
  end
  if (TareLog2 > FractionBits || TareLog2 > 8) begin : gen_check_tare_log2
    $fatal(1, "msn_tare: TareLog2 = %0d must be at most 8 and FractionBits = %0d", TareLog2, FractionBits);
  end
  // b overshoots by a step of at most 255: with fewer bits it could wrap around.
  if (SampleBits + FractionBits < 9) begin : gen_check_zero
    $fatal(1, "msn_tare: SampleBits = %0d and FractionBits = %0d must add to 9 or more", SampleBits,
           FractionBits);
  end

  // Frames. After a frame the next one waits until this one's words are all written and the first are read again,
  // so that no word is read before it is written, however small the array.
  localparam int unsigned Drain = 4;
  logic accept, was_whole, midway, ending, restart, done, word_valid;
  logic loading, pressed, ask, load_due, load_change, change_next, midway_next, ending_next;
  logic closed;  // load_due || ending, registered a clock ahead, for timing
  logic [2:0] drain;
  logic [15:0] tared_count, refused_count;
  logic [31:0] swallowed_count;  // frames dropped while loading
  logic [Lanes-1:0] written;
  assign ask     = cfg_i.average || (start_i && cfg_i.at_start);
  assign written = (cfg_i.write_written && {1'b0, cfg_i.word} < 21'(Beats)) ? Lanes'(cfg_i.write) : '0;
  assign in_ready_o = (out_ready_i || !out_valid_o) && word_valid && !closed;
  assign accept     = in_valid_i && in_ready_o;
  assign restart    = rst_i || drain != '0 || load_due;  // a clock after the last beat: accept is known late
  assign done       = ending && drain == 3'd1;

  // The purpose of the present frame. Averaging and loading begin only between frames.
  logic fresh, asked, asked_force, averaging, forced, commit, any_contact, load_next;
  logic working, working_next;  // averaging || commit, registered as in_ready_o depends on it
  logic [7:0] frames;
  assign working_next = done && was_whole && !loading ? averaging && (forced || !any_contact) : working;
  assign load_next    = cfg_i.load && !working;
  assign load_due     = !midway && load_change;
  assign change_next  = (cfg_i.load && !working_next) != loading && !load_due;
  assign midway_next  = accept || (midway && !done);
  assign ending_next  = accept ? in_last_i : ending && drain > 3'd1;
  assign status_o     = {loading, asked || averaging || commit, pressed, tared_count, refused_count,
                         swallowed_count};

  always_ff @(posedge clk_i) begin
    midway <= midway_next;
    ending <= ending_next;
    closed <= (change_next && !midway_next) || ending_next;
    if (accept) was_whole <= in_last_i && in_fits_i;
    if (accept && in_last_i) drain <= 3'(Drain);
    else if (drain != '0) drain <= drain - 1'b1;

    if (ask) {asked, asked_force} <= {1'b1, cfg_i.force_ || start_i};
    working     <= working_next;
    load_change <= change_next;
    if (load_due) begin
      loading <= load_next;
      fresh         <= fresh && !load_next;
      drain         <= 3'(Drain);
    end else if (asked && !midway && !averaging && !commit && !loading) begin
      asked     <= ask;
      averaging <= 1'b1;
      working   <= 1'b1;
      forced    <= asked_force;
      frames    <= '0;
    end

    if (done) begin
      if (was_whole && !loading) begin
        pressed <= any_contact;
        fresh     <= 1'b0;
        commit    <= 1'b0;
        tared_count <= tared_count + 16'(commit);
        frames    <= frames + 1'b1;
        if (averaging && any_contact && !forced) begin
          averaging <= 1'b0;
          refused_count <= refused_count + 1'b1;
        end else if (averaging && frames == 8'((1 << TareLog2) - 1)) begin
          averaging <= 1'b0;
          commit    <= 1'b1;
        end
      end else begin
        frames <= '0;
      end
      if (loading) swallowed_count <= swallowed_count + 1'b1;
    end

    if (rst_i) begin
      {midway, ending, closed, asked, averaging, commit, working} <= '0;
      {loading, load_change, pressed} <= '0;
      {tared_count, refused_count, swallowed_count} <= '0;
      fresh <= 1'b1;
      drain <= '0;
    end
  end

  // Two clocks ahead of the samples: add an averaging's result to the zero; then round it.
  logic                      table_valid, ahead_valid, advance, unused_state_end;
  logic                      spoilt, spoilt_ahead, spoilt_next;  // of the words beside them
  logic [Lanes*PartBits-1:0] word, write_data;
  logic [Lanes-1:0]          rounded_ready, rounded_valid;
  assign advance    = rounded_ready[0];
  assign word_valid = rounded_valid[0];
  if (Lanes > 1) begin : gen_alike
    logic unused_alike;
    assign unused_alike = ^{rounded_ready[Lanes-1:1], rounded_valid[Lanes-1:1]};
  end

  logic [Lanes-1:0]  write;
  logic [IdBits-1:0] place_q, write_place;
  msn_frame_table #(.Words(Beats), .Parts(Lanes), .PartBits(PartBits), .Banks(1)) u_state (
    .clk_i, .restart_i(restart), .bank_i(1'b0), .advance_i(advance),
    .out_valid_o(table_valid), .out_data_o(word), .out_spoilt_o(spoilt),
    .at_end_o(unused_state_end),
    .write_i(write), .write_bank_i(1'b0), .write_word_i(write_place), .write_data_i(write_data)
  );

  always_ff @(posedge clk_i) begin
    if (advance) ahead_valid <= table_valid;
    if (advance) {spoilt_next, spoilt_ahead} <= {spoilt_ahead, spoilt};
    if (restart) ahead_valid <= 1'b0;
  end

  // A word that was written as it was read is undefined. A beat that does not fit and a frame that is dropped may
  // take one, as neither uses it.
  msn_check u_word_is_defined (
    .clk_i, .rst_i, .wrong_i(!rst_i && accept && in_fits_i && !loading && spoilt_next)
  );

  // 1: the sample's register. The zeros' update follows it in a pipeline that never stalls.
  logic             learn, learn_q;
  logic [Lanes-1:0] pressing;

  always_ff @(posedge clk_i) begin
    if (out_ready_i || !out_valid_o) begin
      out_valid_o    <= accept && !loading;
      out_mask_o     <= in_mask_i;
      out_id_o       <= in_id_i;
      out_fits_o     <= in_fits_i;
      out_row_last_o <= in_row_last_i;
      out_last_o     <= in_last_i;
    end
    learn       <= accept && in_fits_i && !loading;
    learn_q     <= learn;
    place_q     <= out_id_o;
    write       <= loading ? written : {Lanes{learn_q}};
    write_place <= loading ? cfg_i.word[IdBits-1:0] : place_q;
    any_contact <= any_contact || (learn_q && |pressing);
    if (done) any_contact <= 1'b0;
    if (rst_i) begin
      out_valid_o <= 1'b0;
      learn       <= 1'b0;
      learn_q     <= 1'b0;
      write       <= '0;
      any_contact <= 1'b0;
    end
  end

  for (genvar k = 0; k < Lanes; k++) begin : gen_lane
    logic signed [ZeroBits-1:0] kept_zero, found, zero_ahead, zero_next, zero_1, zero_2, zero_moved;
    logic signed [SumBits-1:0]  kept_sum, sum_ahead, sum_next, sum_1, sum_2;
    logic [SampleBits-1:0]      rounded;
    logic signed [DiffBits-1:0] tared, seen;
    logic                       over, over_q, negative, nonzero;
    assign {kept_zero, kept_sum} = {word[k*PartBits+SumBits+:ZeroBits], word[k*PartBits+:SumBits]};
    assign found = ZeroBits'(kept_sum) <<< (FractionBits - TareLog2);

    always_ff @(posedge clk_i) begin
      if (advance) begin
        zero_ahead <= fresh ? '0 : kept_zero + (commit ? found : '0);
        sum_ahead  <= kept_sum;
        zero_next  <= zero_ahead;
        sum_next   <= sum_ahead;
      end
    end

    msn_round_sat #(.InWidth(ZeroBits), .OutWidth(SampleBits), .DropBits(FractionBits)) u_round (
      .clk_i, .rst_i(restart),
      .in_valid_i(ahead_valid), .in_ready_o(rounded_ready[k]), .in_data_i(zero_ahead),
      .out_valid_o(rounded_valid[k]), .out_ready_i(accept), .out_data_o(rounded)
    );

    assign tared = DiffBits'(signed'(in_data_i[k*SampleBits+:SampleBits])) - DiffBits'(signed'(rounded));
    assign out_data_o[k*DiffBits+:DiffBits] = out_fits_o ? seen : '0;
    msn_compare #(.Width(DiffBits)) u_over (
      .a_i(seen), .b_i(signed'({1'b0, SampleBits'(cfg_i.contact)})), .greater_o(over)
    );

    logic                       surplus, mask_q, follow;
    logic signed [ZeroBits-1:0] rate;
    assign surplus     = out_row_last_o && (RowBeats - 1) * Lanes + k >= Columns;
    assign pressing[k] = over_q && !mask_q;
    assign rate       = signed'(ZeroBits'(cfg_i.step));
    assign zero_moved = negative ? zero_2 - rate : zero_2 + rate;
    assign follow     = nonzero && !over_q && !averaging && !commit;
    always_ff @(posedge clk_i) begin
      if (out_ready_i || !out_valid_o) seen <= tared;
      if (accept) {zero_1, sum_1} <= {zero_next, sum_next};

      over_q   <= over;
      mask_q   <= out_mask_o[k] || surplus;
      negative <= seen[DiffBits-1];
      nonzero  <= seen != '0;
      zero_2   <= zero_1;
      sum_2    <= (frames == '0 ? '0 : sum_1) + SumBits'(seen);

      write_data[k*PartBits+:PartBits] <= loading ?
          {DiffBits'(signed'(SampleBits'(cfg_i.zero))), {(FractionBits + SumBits) {1'b0}}} :
          {follow ? zero_moved : zero_2, averaging ? sum_2 : SumBits'(0)};
    end
  end

  logic unused_cfg;  // the register's bits for more lanes and words than this build has
  assign unused_cfg = ^cfg_i;

endmodule
