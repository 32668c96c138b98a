// User logic for the node `ros2_ether`, as the ROS2rapper manual describes it: publishes a text with a number on /bbb every
// PERIOD cycles, and shows by LEDs how long a message it received on /aaa.
//
//   4.2  the message is changed between `grant` and `rel`; the node sends it when it is given back
//   4.3  the message is read between `grant` and `rel`
//
// Its ports are those that the node has for it, seen from the other side, and led: on the Arty A7 LD4 to LD7.

`default_nettype none

module topic_pub_sub_user #(
  parameter PERIOD = 100000000,
  parameter MAX = 64 // ROS2_MAX_APP_DATA_LEN
) (
  input  wire               clk,
  input  wire               rst_n,
  output reg  [MAX*8-1:0]   ros2_pub_app_data,
  output reg  [7:0]         ros2_pub_app_data_len,
  output reg                ros2_pub_app_data_req,
  output reg                ros2_pub_app_data_rel,
  input  wire               ros2_pub_app_data_grant,
  input  wire [7:0]         ros2_sub_app_data_len,
  output reg                ros2_sub_app_data_req,
  output reg                ros2_sub_app_data_rel,
  input  wire               ros2_sub_app_data_grant,
  input  wire               ros2_sub_app_data_recv,
  input  wire [$clog2(MAX)-1:0] ros2_sub_app_data_addr,
  input  wire               ros2_sub_app_data_ce,
  input  wire               ros2_sub_app_data_we,
  input  wire [7:0]         ros2_sub_app_data_wdata,
  output reg  [3:0]         led
);

  // std_msgs/String: the length with the NUL, in 32 bits, then the text. "Message from FPGA - " has 20 octets; four digits
  // follow, and the NUL. The last octet of a literal is in its lowest bits, where the port wants the first.
  localparam TEXT = 20, DIGITS = 4;
  wire [8*TEXT-1:0] text = "Message from FPGA - ";

  reg [31:0] count;
  reg [4*DIGITS-1:0] number; // decimal
  reg [1:0] tx;
  integer n;

  localparam WAIT = 2'd0, REQUEST = 2'd1, RELEASE = 2'd2;

  always @(posedge clk) begin
    ros2_pub_app_data_rel <= 1'b0;
    count <= count + 1;
    case (tx)
      WAIT: if (count >= PERIOD - 1) begin
        count <= 0;
        ros2_pub_app_data_req <= 1'b1;
        tx <= REQUEST;
      end
      REQUEST: if (ros2_pub_app_data_grant) begin
        ros2_pub_app_data_req <= 1'b0;
        ros2_pub_app_data <= 0;
        ros2_pub_app_data[31:0] <= TEXT + DIGITS + 1;
        for (n = 0; n < TEXT; n = n + 1)
          ros2_pub_app_data[8*(4+n) +: 8] <= text[8*(TEXT-1-n) +: 8];
        for (n = 0; n < DIGITS; n = n + 1)
          ros2_pub_app_data[8*(4+TEXT+n) +: 8] <= 8'h30 + number[4*(DIGITS-1-n) +: 4];
        ros2_pub_app_data_len <= 4 + TEXT + DIGITS + 1;
        ros2_pub_app_data_rel <= 1'b1;
        tx <= RELEASE;
      end
      default: begin // the digits, from the last on, as far as they carry
        number[3:0] <= number[3:0] == 9 ? 4'd0 : number[3:0] + 4'd1;
        if (number[3:0] == 9) begin
          number[7:4] <= number[7:4] == 9 ? 4'd0 : number[7:4] + 4'd1;
          if (number[7:4] == 9) begin
            number[11:8] <= number[11:8] == 9 ? 4'd0 : number[11:8] + 4'd1;
            if (number[11:8] == 9)
              number[15:12] <= number[15:12] == 9 ? 4'd0 : number[15:12] + 4'd1;
          end
        end
        tx <= WAIT;
      end
    endcase
    if (!rst_n) begin
      tx <= WAIT;
      count <= 0;
      number <= 0;
      ros2_pub_app_data <= 0;
      ros2_pub_app_data_len <= 0;
      ros2_pub_app_data_req <= 1'b0;
    end
  end

  // The memory of the received message: of a std_msgs/String the first octet says how long its text is, with the NUL.
  reg [7:0] memory [0:MAX-1];
  reg [7:0] first;
  reg [1:0] rx;

  localparam IDLE = 2'd0, ASK = 2'd1, READ = 2'd2, SHOW = 2'd3;

  always @(posedge clk) begin
    if (ros2_sub_app_data_ce && ros2_sub_app_data_we)
      memory[ros2_sub_app_data_addr] <= ros2_sub_app_data_wdata;
    first <= memory[0];
  end

  always @(posedge clk) begin
    ros2_sub_app_data_rel <= 1'b0;
    case (rx)
      IDLE: if (ros2_sub_app_data_recv) begin
        ros2_sub_app_data_req <= 1'b1;
        rx <= ASK;
      end
      ASK: if (ros2_sub_app_data_grant) begin
        ros2_sub_app_data_req <= 1'b0;
        rx <= READ;
      end
      READ: rx <= SHOW;
      default: begin
        if (ros2_sub_app_data_len > 4)
          led <= {first > 15, first > 10, first > 5, first > 1};
        ros2_sub_app_data_rel <= 1'b1;
        rx <= IDLE;
      end
    endcase
    if (!rst_n) begin
      rx <= IDLE;
      led <= 0;
      ros2_sub_app_data_req <= 1'b0;
    end
  end

endmodule

`default_nettype wire
