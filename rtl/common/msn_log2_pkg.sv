// SPDX-License-Identifier: Apache-2.0
//
// Table of msn_log2 at 1/256, a fraction of 28 bits, to nearest; entry 0 lowest.
//
//   Entries[i] = log2(1 + i/256), i = 0 .. 256
//
// Written by `python tools/make/tables.py` from integers: no tool computes a logarithm of its own.
// Model: model/meissner/twins/common/log2.py

package msn_log2_pkg;

  // Builds without msn_log2 read this file, too.
  // verilator lint_off UNUSEDPARAM
  localparam logic [257*29-1:0] Entries = {
    29'h10000000, 29'h0ff47279, 29'h0fe8df26, 29'h0fdd4603, 29'h0fd1a709, 29'h0fc60232,
    29'h0fba5778, 29'h0faea6d6, 29'h0fa2f046, 29'h0f9733c1, 29'h0f8b7141, 29'h0f7fa8c0,
    29'h0f73da39, 29'h0f6805a4, 29'h0f5c2afc, 29'h0f504a3b, 29'h0f44635a, 29'h0f387652,
    29'h0f2c831e, 29'h0f2089b7, 29'h0f148a17, 29'h0f088437, 29'h0efc7810, 29'h0ef0659d,
    29'h0ee44cd6, 29'h0ed82db4, 29'h0ecc0832, 29'h0ebfdc48, 29'h0eb3a9f0, 29'h0ea77123,
    29'h0e9b31d9, 29'h0e8eec0d, 29'h0e829fb7, 29'h0e764ccf, 29'h0e69f350, 29'h0e5d9332,
    29'h0e512c6e, 29'h0e44befd, 29'h0e384ad7, 29'h0e2bcff6, 29'h0e1f4e51, 29'h0e12c5e3,
    29'h0e0636a2, 29'h0df9a089, 29'h0ded038e, 29'h0de05fac, 29'h0dd3b4da, 29'h0dc70310,
    29'h0dba4a48, 29'h0dad8a78, 29'h0da0c39a, 29'h0d93f5a6, 29'h0d872093, 29'h0d7a445b,
    29'h0d6d60f4, 29'h0d607656, 29'h0d53847b, 29'h0d468b59, 29'h0d398ae8, 29'h0d2c8321,
    29'h0d1f73fa, 29'h0d125d6b, 29'h0d053f6d, 29'h0cf819f6, 29'h0ceaecff, 29'h0cddb87d,
    29'h0cd07c6a, 29'h0cc338bb, 29'h0cb5ed69, 29'h0ca89a6b, 29'h0c9b3fb7, 29'h0c8ddd45,
    29'h0c80730b, 29'h0c730101, 29'h0c65871e, 29'h0c580558, 29'h0c4a7ba6, 29'h0c3ce9fe,
    29'h0c2f5058, 29'h0c21aeaa, 29'h0c1404eb, 29'h0c065310, 29'h0bf89911, 29'h0bead6e3,
    29'h0bdd0c7d, 29'h0bcf39d4, 29'h0bc15ee0, 29'h0bb37b96, 29'h0ba58feb, 29'h0b979bd7,
    29'h0b899f4e, 29'h0b7b9a46, 29'h0b6d8cb5, 29'h0b5f7691, 29'h0b5157cf, 29'h0b433065,
    29'h0b350047, 29'h0b26c76c, 29'h0b1885c8, 29'h0b0a3b50, 29'h0afbe7fa, 29'h0aed8bbb,
    29'h0adf2686, 29'h0ad0b852, 29'h0ac24113, 29'h0ab3c0be, 29'h0aa53746, 29'h0a96a4a1,
    29'h0a8808c4, 29'h0a7963a1, 29'h0a6ab52e, 29'h0a5bfd5e, 29'h0a4d3c26, 29'h0a3e7179,
    29'h0a2f9d4c, 29'h0a20bf92, 29'h0a11d83f, 29'h0a02e747, 29'h09f3ec9c, 29'h09e4e832,
    29'h09d5d9fd, 29'h09c6c1f0, 29'h09b79ffe, 29'h09a87419, 29'h09993e35, 29'h0989fe45,
    29'h097ab43b, 29'h096b600a, 29'h095c01a4, 29'h094c98fb, 29'h093d2603, 29'h092da8ac,
    29'h091e20ea, 29'h090e8eae, 29'h08fef1ea, 29'h08ef4a8f, 29'h08df988f, 29'h08cfdbdc,
    29'h08c01468, 29'h08b04222, 29'h08a064fd, 29'h08907cea, 29'h088089d9, 29'h08708bbb,
    29'h08608280, 29'h08506e1a, 29'h08404e79, 29'h0830238d, 29'h081fed46, 29'h080fab94,
    29'h07ff5e67, 29'h07ef05ae, 29'h07dea15a, 29'h07ce315a, 29'h07bdb59d, 29'h07ad2e12,
    29'h079c9aa8, 29'h078bfb4f, 29'h077b4ff5, 29'h076a9889, 29'h0759d4f8, 29'h07490532,
    29'h07382925, 29'h072740be, 29'h07164beb, 29'h07054a9b, 29'h06f43cba, 29'h06e32237,
    29'h06d1fafe, 29'h06c0c6fc, 29'h06af861e, 29'h069e3852, 29'h068cdd83, 29'h067b759d,
    29'h066a008e, 29'h06587e41, 29'h0646eea2, 29'h0635519d, 29'h0623a71d, 29'h0611ef0d,
    29'h06002959, 29'h05ee55eb, 29'h05dc74af, 29'h05ca858e, 29'h05b88873, 29'h05a67d49,
    29'h059463f9, 29'h05823c6d, 29'h0570068e, 29'h055dc247, 29'h054b6f7f, 29'h05390e20,
    29'h05269e13, 29'h05141f40, 29'h0501918f, 29'h04eef4e8, 29'h04dc4934, 29'h04c98e59,
    29'h04b6c43f, 29'h04a3eacd, 29'h049101eb, 29'h047e097e, 29'h046b016d, 29'h0457e99e,
    29'h0444c1f7, 29'h04318a5d, 29'h041e42b7, 29'h040aeae9, 29'h03f782d7, 29'h03e40a67,
    29'h03d0817d, 29'h03bce7fc, 29'h03a93dca, 29'h039582c8, 29'h0381b6da, 29'h036dd9e3,
    29'h0359ebc6, 29'h0345ec64, 29'h0331dba1, 29'h031db95d, 29'h0309857a, 29'h02f53fd9,
    29'h02e0e85b, 29'h02cc7edf, 29'h02b80347, 29'h02a37572, 29'h028ed53f, 29'h027a228e,
    29'h02655d3c, 29'h02508529, 29'h023b9a33, 29'h02269c37, 29'h02118b12, 29'h01fc66a1,
    29'h01e72ec1, 29'h01d1e34e, 29'h01bc8424, 29'h01a7111e, 29'h01918a17, 29'h017beee9,
    29'h01663f70, 29'h01507b83, 29'h013aa2fe, 29'h0124b5b8, 29'h010eb38a, 29'h00f89c4c,
    29'h00e26fd6, 29'h00cc2dfe, 29'h00b5d69c, 29'h009f6985, 29'h0088e68f, 29'h00724d8f,
    29'h005b9e5a, 29'h0044d8c4, 29'h002dfca1, 29'h001709c4, 29'h00000000
  };
  // verilator lint_on UNUSEDPARAM

endpackage
