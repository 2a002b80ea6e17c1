// SPDX-License-Identifier: Apache-2.0
//
// Ports of owed_delay connected to the inside of an msn_delay, `of`: a ring if deeper than 4, else a line of registers.

`define OWED_RING(of) .line_i('0), .slot_i(of.gen_ring.slot), .newest_i(of.gen_ring.newest), \
    .oldest_i(of.gen_ring.u_ring.fetched), .oldest_q_i(of.gen_ring.oldest), .word_i(of.gen_ring.u_ring.memory[slot])
`define OWED_LINE(of) .line_i(of.gen_registers.line), .slot_i('0), .newest_i('0), .oldest_i('0), .oldest_q_i('0), \
    .word_i('0)
