// Writes recordings of ROS 2 into a folder, with Foxglove's own writers (npm: @mcap/core,
// @foxglove/rosmsg2-serialization): node make_mcap.js FOLDER, with NODE_PATH where they are.
//
// Three frames of 8 x 6 pixels, 1/30 s apart from 100.5 s on; colour (u * 10, v * 20, frame), depth 1000 + 100 * frame
// + u + 10 * v millimetres, 2 ms later. independent_writer_test.cpp knows these numbers.
"use strict";
const fs = require("fs");
const path = require("path");
const { McapWriter } = require("@mcap/core");
const { MessageWriter } = require("@foxglove/rosmsg2-serialization");

const WIDTH = 8, HEIGHT = 6, FRAMES = 3;

const plain = (type, name) => ({ type, name });
const complex = (type, name) => ({ type, name, isComplex: true });
const array = (type, name, arrayLength) => ({ type, name, isArray: true, arrayLength });
const header = [
    { name: "std_msgs/Header",
        definitions: [complex("builtin_interfaces/Time", "stamp"), plain("string", "frame_id")] },
    { name: "builtin_interfaces/Time", definitions: [plain("int32", "sec"), plain("uint32", "nanosec")] },
];
const region = ["x_offset", "y_offset", "height", "width"].map((name) => plain("uint32", name));
const types = {
    "sensor_msgs/msg/Image": [
        { definitions: [complex("std_msgs/Header", "header"), plain("uint32", "height"), plain("uint32", "width"),
            plain("string", "encoding"), plain("uint8", "is_bigendian"), plain("uint32", "step"),
            array("uint8", "data")] },
        ...header],
    "sensor_msgs/msg/CameraInfo": [
        { definitions: [complex("std_msgs/Header", "header"), plain("uint32", "height"), plain("uint32", "width"),
            plain("string", "distortion_model"), array("float64", "d"), array("float64", "k", 9),
            array("float64", "r", 9), array("float64", "p", 12), plain("uint32", "binning_x"),
            plain("uint32", "binning_y"), complex("sensor_msgs/RegionOfInterest", "roi")] },
        ...header,
        { name: "sensor_msgs/RegionOfInterest", definitions: [...region, plain("bool", "do_rectify")] }],
};

function headerAt(nanoseconds) {
    const second = 1000000000n;
    return { stamp: { sec: Number(nanoseconds / second), nanosec: Number(nanoseconds % second) }, frame_id: "camera" };
}

function image(nanoseconds, encoding, pixelBytes, data) {
    return { header: headerAt(nanoseconds), height: HEIGHT, width: WIDTH, encoding, is_bigendian: 0,
        step: WIDTH * pixelBytes, data };
}

function cameraInfo(nanoseconds) {
    return { header: headerAt(nanoseconds), height: HEIGHT, width: WIDTH, distortion_model: "plumb_bob",
        d: [0.1, -0.2, 0.001, 0.002, 0.05], k: [9.5, 0, 3.5, 0, 9.25, 2.5, 0, 0, 1], r: new Array(9).fill(0),
        p: new Array(12).fill(0), binning_x: 0, binning_y: 0,
        roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false } };
}

function* messages() {
    for (let frame = 0; frame < FRAMES; ++frame) {
        const time = 100500000000n + BigInt(frame) * 33333000n, later = time + 2000000n;
        const color = new Uint8Array(WIDTH * HEIGHT * 3), depth = new Uint16Array(WIDTH * HEIGHT);
        for (let v = 0; v < HEIGHT; ++v)
            for (let u = 0; u < WIDTH; ++u) {
                color.set([frame, v * 20, u * 10], 3 * (v * WIDTH + u)); // bgr8
                depth[v * WIDTH + u] = 1000 + 100 * frame + u + 10 * v;
            }
        yield ["/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", time, cameraInfo(time)];
        yield ["/camera/color/image_raw", "sensor_msgs/msg/Image", time, image(time, "bgr8", 3, color)];
        yield ["/camera/aligned_depth_to_color/image_raw", "sensor_msgs/msg/Image", later,
            image(later, "16UC1", 2, new Uint8Array(depth.buffer))];
    }
}

async function write(file, options, closed = true) {
    const pieces = [];
    let bytes = 0n;
    const writable = {
        position: () => bytes,
        write: async (piece) => {
            pieces.push(Buffer.from(piece));
            bytes += BigInt(piece.byteLength);
        },
    };
    const mcap = new McapWriter({ writable, chunkSize: 500, ...options });
    await mcap.start({ profile: "ros2", library: "independent" });
    const channels = new Map();
    for (const [topic, type, time, message] of messages()) {
        if (!channels.has(topic)) {
            const schemaId = await mcap.registerSchema({ name: type, encoding: "ros2msg", data: Buffer.from("") });
            channels.set(topic, await mcap.registerChannel(
                { topic, schemaId, messageEncoding: "cdr", metadata: new Map([["offered_qos_profiles", ""]]) }));
        }
        const data = new MessageWriter(types[type]).writeMessage(message);
        await mcap.addMessage({ channelId: channels.get(topic), sequence: 0, logTime: time, publishTime: time, data });
    }
    if (closed) await mcap.end();
    fs.writeFileSync(file, Buffer.concat(pieces));
}

async function main(folder) {
    await write(path.join(folder, "chunks.mcap"), {});
    await write(path.join(folder, "no_index.mcap"), { useMessageIndex: false, useChunkIndex: false });
    await write(path.join(folder, "no_summary.mcap"),
        { useStatistics: false, useSummaryOffsets: false, repeatSchemas: false, repeatChannels: false });
    await write(path.join(folder, "no_chunks.mcap"), { useChunks: false });
    await write(path.join(folder, "unclosed.mcap"), {}, false);
}

main(process.argv[2]);
