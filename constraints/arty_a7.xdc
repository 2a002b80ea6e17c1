# Arty A7-35T or -100T. Not built here: no Vivado was at hand. docs/boards.md says what to connect.
set_property -dict {PACKAGE_PIN E3 IOSTANDARD LVCMOS33} [get_ports clk_100m_i]
create_clock -period 10.000 -name clk_100m [get_ports clk_100m_i]

# USB serial
set_property -dict {PACKAGE_PIN A9 IOSTANDARD LVCMOS33 PULLUP TRUE} [get_ports rx_i]
set_property -dict {PACKAGE_PIN D10 IOSTANDARD LVCMOS33} [get_ports tx_o]

# LD4 to LD7
set_property -dict {PACKAGE_PIN H5 IOSTANDARD LVCMOS33} [get_ports {led_o[0]}]
set_property -dict {PACKAGE_PIN J5 IOSTANDARD LVCMOS33} [get_ports {led_o[1]}]
set_property -dict {PACKAGE_PIN T9 IOSTANDARD LVCMOS33} [get_ports {led_o[2]}]
set_property -dict {PACKAGE_PIN T10 IOSTANDARD LVCMOS33} [get_ports {led_o[3]}]

# PMOD JA: 1 to 4, and 7
set_property -dict {PACKAGE_PIN G13 IOSTANDARD LVCMOS33} [get_ports adc_cs_n_o]
set_property -dict {PACKAGE_PIN B11 IOSTANDARD LVCMOS33} [get_ports adc_mosi_o]
set_property -dict {PACKAGE_PIN A11 IOSTANDARD LVCMOS33 PULLUP TRUE} [get_ports adc_miso_i]
set_property -dict {PACKAGE_PIN D12 IOSTANDARD LVCMOS33} [get_ports adc_sclk_o]
set_property -dict {PACKAGE_PIN D13 IOSTANDARD LVCMOS33 PULLDOWN TRUE} [get_ports moving_i]

# PMOD JB: 1 to 4, 7 to 10
set_property -dict {PACKAGE_PIN E15 IOSTANDARD LVCMOS33} [get_ports {row_o[0]}]
set_property -dict {PACKAGE_PIN E16 IOSTANDARD LVCMOS33} [get_ports {row_o[1]}]
set_property -dict {PACKAGE_PIN D15 IOSTANDARD LVCMOS33} [get_ports {row_o[2]}]
set_property -dict {PACKAGE_PIN C15 IOSTANDARD LVCMOS33} [get_ports {row_o[3]}]
set_property -dict {PACKAGE_PIN J17 IOSTANDARD LVCMOS33} [get_ports {row_o[4]}]
set_property -dict {PACKAGE_PIN J18 IOSTANDARD LVCMOS33} [get_ports {row_o[5]}]
set_property -dict {PACKAGE_PIN K15 IOSTANDARD LVCMOS33} [get_ports {row_o[6]}]
set_property -dict {PACKAGE_PIN J15 IOSTANDARD LVCMOS33} [get_ports {row_o[7]}]

# Both ends are synchronised in the core, or slower than 20 MHz with half a period to spare.
set_false_path -from [get_ports {rx_i moving_i adc_miso_i}]
set_false_path -to [get_ports {tx_o led_o[*] row_o[*] adc_cs_n_o adc_mosi_o adc_sclk_o}]
set_property CFGBVS VCCO [current_design]
set_property CONFIG_VOLTAGE 3.3 [current_design]
