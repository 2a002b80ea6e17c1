"""The register map.

Made by tools/make/registers.py from rtl/registers.rdl: change that, then `make registers`.
"""

from meissner.twins.link.register import read

TABLE = """
core always What this core is
  000 id                   31:0  constant 4d534e52 -
  004 version.patch        7:0   constant 0        -
  004 version.minor        15:8  constant 7        -
  004 version.major        31:16 constant 0        -
  008 features             31:0  features 0        -
  00c size.rows            15:0  status   0        -
  00c size.columns         31:16 status   0        -
  010 clk_khz              31:0  status   0        -
  014 scratch              31:0  setting  0        at_once
  018 widths.detail        7:0   width    0        -
  018 widths.timer         15:8  width    0        -
  018 widths.load          23:16 width    0        -
  018 widths.offset        31:24 width    0        -
  01c beats                20:0  status   0        -
  020 hold                 0:0   setting  0        at_once
  024 lanes                3:0   status   0        -
adc feature Converter of single channels or of four electrodes
  100 enable               0:0   setting  0        at_once
  104 period               23:0  setting  0        at_once
  108 dropped              31:0  status   0        -
  10c overrun              31:0  status   0        -
  110 timeout              31:0  status   0        -
  114 mistagged            31:0  status   0        -
  118 over_range           31:0  status   0        -
slip feature Slip of each channel
  200 threshold            19:0  setting  fffff    at_frame  detail
  204 gross_threshold      19:0  setting  fffff    at_frame  detail
  208 contact_level        19:0  setting  0        at_frame  signed detail
  20c release_level        19:0  setting  0        at_frame  signed detail
  210 contact_rises        0:0   setting  1        at_frame
  214 hold                 15:0  setting  0        at_frame  timer
  218 refractory           15:0  setting  0        at_frame  timer
  21c blank                15:0  setting  0        at_frame  timer
  220 damaged              31:0  status   0        -
  224 blanked              31:0  status   0        -
  228 keep_threshold       19:0  setting  fffff    at_frame  detail
scan feature Scan of an array
  300 enable               0:0   setting  0        at_once
  304 settle               15:0  setting  1        at_scan
  308 period               31:0  setting  0        at_scan
  30c interleave           0:0   setting  0        at_scan
  310 dropped              31:0  status   0        -
  314 overrun              31:0  status   0        -
  318 held                 31:0  status   0        -
  31c lost                 31:0  status   0        -
health feature Health of taxels
  400 band                 16:0  setting  2        at_frame
  404 jump                 16:0  setting  0        at_frame
  408 low                  16:0  setting  0        at_frame  signed
  40c high                 16:0  setting  ffff     at_frame  signed
  410 use.user             0:0   setting  1        at_frame
  410 use.edges            1:1   setting  1        at_frame
  414 still                7:0   setting  0        at_frame
  418 rail                 7:0   setting  0        at_frame
  41c blink                7:0   setting  0        at_frame
  420 clear                0:0   command  0        at_frame
  424 report               0:0   command  0        at_frame
  428 dead                 20:0  status   0        -
  42c railed               20:0  status   0        -
  430 blinking             20:0  status   0        -
tare feature Zero of each taxel
  480 contact              16:0  setting  40       at_frame
  484 step                 7:0   setting  1        at_frame
  488 force                0:0   setting  0        at_once
  48c at_start             0:0   setting  1        at_reset
  490 average              0:0   command  0        at_once
  494 load                 0:0   setting  0        at_once
  498 word                 19:0  setting  0        at_once
  49c zero                 16:0  setting  0        at_once   signed
  4a0 write                7:0   setting  0        at_once   written
  4a4 state.loading        0:0   status   0        -
  4a4 state.taring         1:1   status   0        -
  4a4 state.pressed        2:2   status   0        -
  4a8 tared                15:0  status   0        -
  4ac refused              15:0  status   0        -
  4b0 swallowed            31:0  status   0        -
calibrate feature Calibration of taxels
  500 preset               15:0  setting  0        at_frame
  504 word                 19:0  setting  0        at_once
  508 offset               16:0  setting  0        at_once   signed offset
  50c gain                 15:0  setting  0        at_once
  510 write.lanes          7:0   setting  0        at_once   written
  510 write.row            8:8   setting  0        at_once
  514 swap                 0:0   command  0        at_once
  518 swapping             0:0   status   0        -
cop feature Centre of pressure of an array
  600 min_load             31:0  setting  1        at_frame  load
  604 damaged              31:0  status   0        -
cop4 feature Four electrodes
  700 rail                 16:0  setting  ffff     at_frame
  704 kx                   16:0  setting  0        at_frame
  708 shift_x              3:0   setting  0        at_frame
  70c ky                   16:0  setting  0        at_frame
  710 shift_y              3:0   setting  0        at_frame
  714 kf                   16:0  setting  0        at_frame
  718 shift_load           3:0   setting  0        at_frame
  71c p0                   17:0  setting  0        at_frame  signed
  720 p1                   17:0  setting  0        at_frame  signed
  724 p2                   17:0  setting  0        at_frame  signed
  728 p3                   17:0  setting  0        at_frame  signed
  72c p4                   17:0  setting  0        at_frame  signed
  730 p5                   17:0  setting  0        at_frame  signed
  734 min_load             15:0  setting  1        at_frame
  738 top                  15:0  setting  ffff     at_frame
  73c idle                 16:0  setting  ffff     at_frame  signed
  740 busy                 16:0  setting  ffff     at_frame  signed
  744 imbalance            17:0  setting  3ffff    at_frame
cop_slip feature Slip from the load of four electrodes
  800 drop                 7:0   setting  80       at_frame
  804 move                 15:0  setting  0        at_frame
  808 min_load             15:0  setting  0        at_frame
  80c hold                 15:0  setting  0        at_frame
  810 refractory           15:0  setting  0        at_frame
link feature Packets
  900 images               0:0   setting  1        at_frame
  904 packets              31:0  status   0        -
  908 cop_dropped          31:0  status   0        -
  90c image_dropped        31:0  status   0        -
  910 rejected             31:0  status   0        -
  914 events.none          0:0   setting  1        at_frame
  914 events.contact       1:1   setting  1        at_frame
  914 events.incipient     2:2   setting  1        at_frame
  914 events.gross         3:3   setting  1        at_frame
  914 events.release       4:4   setting  1        at_frame
  918 states               0:0   command  0        at_once
  91c changes_lost         31:0  status   0        -
grip feature Grip reflex
  a00 enable               0:0   setting  0        at_once
  a04 period               23:0  setting  f4240    at_once
  a08 step                 15:0  setting  100      at_once
  a0c decay                15:0  setting  0        at_once
  a10 minimum              15:0  setting  400      at_once
  a14 maximum              15:0  setting  ea60     at_once
  a18 rate                 15:0  setting  800      at_once
  a1c watchdog             15:0  setting  14       at_once
  a20 rule                 0:0   setting  0        at_once
  a24 mode                 0:0   setting  0        at_once
  a28 immediate            0:0   setting  0        at_once
  a2c override             0:0   setting  0        at_once
  a30 override_value       15:0  setting  0        at_once
  a34 divide               7:0   setting  0        at_once
  a38 low                  16:0  setting  0        at_once   signed
  a3c high                 16:0  setting  fff      at_once   signed
  a40 rail                 7:0   setting  8        at_once
  a44 command              15:0  status   0        -
  a48 increment            16:0  status   0        -         signed
  a4c fault                4:0   status   0        -
  a50 faulty               7:0   status   0        -
  a54 commands             31:0  status   0        -
  a58 tightenings          31:0  status   0        -
  a5c speed_gain           15:0  setting  0        at_once
  a60 boost                2:0   setting  0        at_once
shear_speed feature Speed of shear
  b00 enable               0:0   setting  0        at_once
  b04 k0                   25:0  setting  9eb85    while_off
  b08 k1                   17:0  setting  3bae1    while_off signed
  b0c exponent             15:0  setting  48ba     while_off
  b10 vi_min               25:0  setting  ccccd    while_off signed
  b14 vi_max               25:0  setting  19999a   while_off signed
  b18 noise                25:0  setting  a3d7     while_off
  b1c still                25:0  setting  419      while_off
  b20 full                 16:0  setting  ff8      while_off signed
  b24 limit                23:0  setting  300000   while_off
  b28 travel               31:0  setting  190000   while_off
  b2c hold                 0:0   setting  0        at_once
  b30 hold_cycles          7:0   setting  0        at_once
  b34 select               2:0   setting  0        at_once
  b38 channel0.speed       23:0  status   0        -
  b38 channel0.flags       31:24 status   0        -
  b3c channel1.speed       23:0  status   0        -
  b3c channel1.flags       31:24 status   0        -
  b40 channel2.speed       23:0  status   0        -
  b40 channel2.flags       31:24 status   0        -
  b44 channel3.speed       23:0  status   0        -
  b44 channel3.flags       31:24 status   0        -
  b48 channel4.speed       23:0  status   0        -
  b48 channel4.flags       31:24 status   0        -
  b4c channel5.speed       23:0  status   0        -
  b4c channel5.flags       31:24 status   0        -
  b50 channel6.speed       23:0  status   0        -
  b50 channel6.flags       31:24 status   0        -
  b54 channel7.speed       23:0  status   0        -
  b54 channel7.flags       31:24 status   0        -
  b58 vi                   25:0  status   0        -         signed
  b5c rise                 26:0  status   0        -         signed
  b60 windows              31:0  status   0        -
forest feature Forest
  c00 size.features        8:0   status   0        -
  c00 size.bits            13:9  status   0        -
  c00 size.engines         20:14 status   0        -
  c00 size.banks           22:21 status   0        -
  c00 size.frames          23:23 status   0        -
  c04 room.trees           15:0  status   0        -
  c04 room.classes         31:16 status   0        -
  c08 nodes                22:0  status   0        -
  c0c leaves               16:0  status   0        -
  c10 target.kind          1:0   setting  0        at_once
  c10 target.engine        7:2   setting  0        at_once
  c10 target.label         23:8  setting  0        at_once
  c14 address              21:0  setting  0        at_once   written
  c18 high                 31:0  setting  0        at_once
  c1c data                 31:0  setting  0        at_once   written
  c20 clear                0:0   command  0        at_once
  c24 swap                 0:0   command  0        at_once
  c28 state.loaded         0:0   status   0        -
  c28 state.waits          1:1   status   0        -
  c28 state.swapping       2:2   status   0        -
  c28 state.refused        3:3   status   0        -
  c28 state.error          6:4   status   0        -
  c2c written              31:0  status   0        -
  c30 feature              21:0  setting  0        at_once   signed written
  c30 feature.index        29:22 setting  0        at_once
  c34 start                0:0   command  0        at_once
  c38 slip                 31:0  setting  0        at_once
  c3c grip                 0:0   setting  0        at_once
  c40 label                15:0  status   0        -
  c44 best                 31:0  status   0        -
  c48 select               15:0  setting  0        at_once
  c4c votes                31:0  status   0        -
  c50 decisions            31:0  status   0        -
  c54 changes              31:0  status   0        -
  c58 missed               15:0  status   0        -
  c5c absent               15:0  status   0        -
  c60 late                 15:0  status   0        -
  c64 broken               15:0  status   0        -
display feature Pin display
  d00 enable               0:0   setting  0        at_once
  d04 increment            31:0  setting  0        at_once
  d08 burst_period         11:0  setting  0        at_once
  d0c burst_on             11:0  setting  0        at_once
  d10 top                  7:0   setting  ff       at_once
  d14 most                 11:0  setting  fff      at_reset
  d18 duty                 15:0  setting  4e20     at_reset
  d1c watchdog             3:0   setting  3        at_reset
  d20 stop                 15:0  setting  7d0      at_reset
  d24 source               0:0   setting  0        at_once
  d28 floor                15:0  setting  1        at_once
  d2c step                 15:0  setting  0        at_once
  d30 marker               0:0   setting  0        at_once
  d34 cue                  7:0   setting  0        at_once
  d38 octant               2:0   setting  0        at_once
  d3c health               0:0   setting  1        at_once
  d40 levels.next          23:0  setting  0        at_once
  d40 levels.last          24:24 setting  0        at_once   written
  d44 size.rows            7:0   status   0        -
  d44 size.columns         15:8  status   0        -
  d44 size.bits            23:16 status   0        -
  d48 state.running        0:0   status   0        -
  d48 state.fault          1:1   status   0        -
  d48 state.limited        2:2   status   0        -
  d48 state.pins           19:8  status   0        -
  d4c dropped              15:0  status   0        -
  d50 faults               31:0  status   0        -
"""
GROUPS = read(TABLE)
