
-- dissector.lua - a dissector for Wireshark of the messages that the table `plant` above tells.
--
-- It takes CAN frames whose identifier is one of the plant's, and hands the frames in UDP packets of the
-- cannelloni format to the dissector of CAN. Filters are contactplant.MESSAGE.SIGNAL, and for what all
-- messages have contactplant.session, .counter, .checksum, and contactplant.cause.

local proto = Proto("contactplant", "contactplant " .. plant.model)
local shared = {CHECKSUM = true, COUNTER = true, SESSION = true, CAUSE = true}
local COUNTER_STATES = 15
local field = {} -- by filter
local fields = {}
local byte_xor = bit32 and bit32.bxor or bit and bit.bxor or load("return function(a, b) return a ~ b end")()

local function filter(message, signal)
    local name = shared[signal.name] and signal.name or message.name .. "." .. signal.name
    return "contactplant." .. name:lower()
end

-- Whole numbers without a scale are integers, all others doubles.
local function type_of(signal)
    if signal.kind == "f" or signal.factor ~= 1 then
        return ftypes.DOUBLE, base.NONE
    end
    if signal.kind == "i" then
        return ftypes.INT32, base.DEC
    end
    return signal.bits > 32 and ftypes.UINT64 or ftypes.UINT32, base.DEC
end

local function add_field(name, f)
    field[name] = f
    fields[#fields + 1] = f
end

for _, message in pairs(plant.message) do
    for _, signal in ipairs(message.signal) do
        local name, kind, shown = filter(message, signal), type_of(signal)
        signal.filter, signal.type = name, kind
        if not field[name] then
            add_field(name, ProtoField.new(signal.name, name, kind, kind ~= ftypes.DOUBLE and signal.value or nil,
                                           shown, nil, signal.meaning))
        end
    end
end
add_field("kind", ProtoField.string("contactplant.message", "Message"))
add_field("answers", ProtoField.framenum("contactplant.answers", "Answer to", base.NONE, frametype.REQUEST))
add_field("answered", ProtoField.framenum("contactplant.answered", "Answered in", base.NONE, frametype.RESPONSE))
add_field("missing", ProtoField.uint32("contactplant.missing", "Frames missing before this one"))
proto.fields = fields

local bad_checksum = ProtoExpert.new("contactplant.bad_checksum", "wrong checksum", expert.group.CHECKSUM,
                                     expert.severity.ERROR)
local bad_length = ProtoExpert.new("contactplant.bad_length", "a message of the plant has 8 bytes",
                                   expert.group.MALFORMED, expert.severity.ERROR)
local gap = ProtoExpert.new("contactplant.gap", "frames are missing", expert.group.SEQUENCE, expert.severity.WARN)
local refused = ProtoExpert.new("contactplant.refused", "refused", expert.group.RESPONSE_CODE, expert.severity.WARN)
proto.experts = {bad_checksum, bad_length, gap, refused}

-- ---- bytes ----

local crc_of = {}
for byte = 0, 255 do
    local crc = byte
    for _ = 1, 8 do
        crc = crc >= 128 and byte_xor(crc * 2 % 256, 0x1D) or crc * 2
    end
    crc_of[byte] = crc
end

local function checksum(id, bytes)
    local crc = crc_of[id % 256]
    crc = crc_of[byte_xor(crc, math.floor(id / 256) % 256)]
    for i = 1, 7 do
        crc = crc_of[byte_xor(crc, bytes(i, 1):uint())]
    end
    return crc
end

-- Value and bytes of a signal; no value where it is not available.
local function read(signal, bytes)
    local first, last = math.floor(signal.start / 8), math.floor((signal.start + signal.bits - 1) / 8)
    local range = bytes(first, last - first + 1)
    if signal.kind == "f" then
        local value = range:le_float()
        return value == value and value or nil, range
    end
    local number = 0
    for i = last, first, -1 do
        number = number * 256 + bytes(i, 1):uint()
    end
    number = math.floor(number / 2 ^ (signal.start % 8)) % 2 ^ signal.bits
    if signal.kind == "i" and number >= 2 ^ (signal.bits - 1) then
        number = number - 2 ^ signal.bits
    end
    if number == signal.none then
        return nil, range
    end
    return number * signal.factor, range
end

-- ---- what the first pass over the packets remembers ----

local last_counter, asked, note = {}, {}, {}

function proto.init()
    last_counter, asked, note = {}, {}, {}
end

local interface_field = Field.new("frame.interface_id")

-- The interface, so that two plants in one file are two.
local function where()
    local interface = interface_field()
    return interface and interface.value or 0
end

-- The notes of one frame: a packet of cannelloni holds several of them.
local nth, nth_in = 0, 0

local function note_of(pinfo)
    nth = nth_in == pinfo.number and nth + 1 or 0
    nth_in = pinfo.number
    local key = pinfo.number .. "/" .. nth
    note[key] = note[key] or {}
    return note[key]
end

-- A counter goes on by one with each frame of its identifier.
local function note_counter(n, pinfo, id, counter)
    local key = where() .. "/" .. id
    if not pinfo.visited then
        local before = last_counter[key]
        n.missing = before and (counter - before - 1) % COUNTER_STATES or 0
        last_counter[key] = counter
    end
end

local function note_command(n, pinfo, kind, counter)
    if not pinfo.visited then
        asked[where() .. "/" .. kind .. "/" .. counter] = {frame = pinfo.number, note = n}
    end
end

local function note_answer(n, pinfo, kind, counter)
    local of = asked[where() .. "/" .. kind .. "/" .. counter]
    if of and not pinfo.visited then
        n.answers = of.frame
        of.note.answered = of.note.answered or pinfo.number
    end
end

-- ---- a message ----

-- The text behind the name in the list of packets.
local function told(signal, value)
    local name = signal.value and signal.value[value]
    if signal.name == "CHECKSUM" or signal.name == "COUNTER" then
        return ""
    end
    local number = math.floor(value) == value and math.abs(value) < 2 ^ 53 and string.format("%.0f", value)
    return " " .. signal.name .. "=" .. (name or number or string.format("%.6g", value)) ..
               (signal.unit ~= "" and " " .. signal.unit or "")
end

local function add_value(tree, signal, value, range)
    if value == nil then
        tree:add(range, signal.name .. ": not available")
        return
    end
    if signal.type == ftypes.UINT64 then
        value = UInt64(value % 2 ^ 32, math.floor(value / 2 ^ 32))
    end
    local item = tree:add(field[signal.filter], range, value)
    if signal.unit ~= "" then
        item:append_text(" " .. signal.unit)
    end
end

-- Adds all signals that this frame has; their values by name, and their text.
local function add_signals(tree, message, bytes)
    local by, value, text = nil, {}, ""
    for _, signal in ipairs(message.signal) do
        if signal.selected == nil or signal.selected == by then
            local v, range = read(signal, bytes)
            add_value(tree, signal, v, range)
            value[signal.name] = v
            text = text .. (v and told(signal, v) or " " .. signal.name .. " not available")
            if signal.selects then
                by = v
            end
        end
    end
    return value, text
end

local function add_notes(tree, n)
    if n.missing and n.missing > 0 then
        tree:add(field.missing, n.missing):set_generated()
        tree:add_proto_expert_info(gap, n.missing .. " or more frames of this identifier are missing before it")
    end
    if n.answers then
        tree:add(field.answers, n.answers):set_generated()
    end
    if n.answered then
        tree:add(field.answered, n.answered):set_generated()
    end
end

local function name_of_message(kind)
    return plant.message[kind] and plant.message[kind].name or string.format("message %.0f", kind)
end

local function dissect(bytes, pinfo, tree, kind)
    local message, id, n = plant.message[kind], plant.base + kind, note_of(pinfo)
    local value, text = add_signals(tree, message, bytes)
    if checksum(id, bytes) ~= value.CHECKSUM then
        tree:add_proto_expert_info(bad_checksum)
        return message.name .. " with a wrong checksum"
    end
    note_counter(n, pinfo, id, value.COUNTER)
    if message.command then
        note_command(n, pinfo, kind, value.COUNTER)
    elseif value.MESSAGE and value.ECHO_COUNTER then
        note_answer(n, pinfo, value.MESSAGE, value.ECHO_COUNTER)
    end
    add_notes(tree, n)
    if message.name == "REPLY" and value.CAUSE ~= 0 then
        tree:add_proto_expert_info(refused, name_of_message(value.MESSAGE) .. " is refused")
        text = " refuses " .. name_of_message(value.MESSAGE) .. ":" .. text
    end
    return message.name .. text
end

function proto.dissector(tvb, pinfo, tree)
    local kind = pinfo.match_uint - plant.base
    if not plant.message[kind] then
        return 0
    end
    local below = tree:add(proto, tvb(), "contactplant " .. plant.message[kind].name)
    pinfo.cols.protocol = "contactplant"
    if tvb:len() ~= 8 then
        below:add_proto_expert_info(bad_length)
        return tvb:len()
    end
    below:add(field.kind, tvb(), plant.message[kind].name):set_generated()
    pinfo.cols.info = dissect(tvb(0, 8), pinfo, below, kind)
    return tvb:len()
end

local identifiers = DissectorTable.get(plant.extended and "can.extended_id" or "can.id")
for kind in pairs(plant.message) do
    identifiers:add(plant.base + kind, proto)
end

-- ---- cannelloni: CAN frames in UDP packets ----

local packet = Proto("contactplant_cannelloni", "CAN over UDP (cannelloni)")
local DATA, VERSION, HEADER, FRAME_HEADER, REMOTE, FD = 0, 2, 5, 5, 0x40000000, 0x80
local sequence = ProtoField.uint8("contactplant_cannelloni.sequence", "Sequence number")
local count = ProtoField.uint16("contactplant_cannelloni.frames", "Frames")
local no_end = ProtoExpert.new("contactplant_cannelloni.malformed", "the frames do not end with the packet",
                               expert.group.MALFORMED, expert.severity.ERROR)
packet.fields = {sequence, count}
packet.experts = {no_end}
local can = DissectorTable.get("wtap_encap"):get_dissector((wtap_encaps or wtap).SOCKETCAN)

-- The length of a frame at an offset, and of its header; nothing where the packet ends before.
local function frame_at(tvb, at)
    if at + FRAME_HEADER > tvb:len() then
        return nil
    end
    local length, header = tvb(at + 4, 1):uint(), FRAME_HEADER
    if length >= FD then
        length, header = length - FD, header + 1
    end
    local remote = math.floor(tvb(at, 4):uint() / REMOTE) % 2 == 1
    local held = remote and 0 or length
    return at + header + held <= tvb:len() and length or nil, header, held
end

-- The frame as Linux has it, for the dissector of CAN.
local function hand_over(tvb, at, length, header, held, pinfo, tree)
    local linux = ByteArray.new("00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00")
    for i = 0, 3 do
        linux:set_index(i, tvb(at + i, 1):uint())
    end
    linux:set_index(4, length)
    for i = 0, math.min(held, 8) - 1 do
        linux:set_index(8 + i, tvb(at + header + i, 1):uint())
    end
    can:call(linux:tvb("CAN frame"), pinfo, tree)
end

function packet.dissector(tvb, pinfo, tree)
    if tvb:len() < HEADER or tvb(0, 1):uint() ~= VERSION or tvb(1, 1):uint() ~= DATA then
        return 0
    end
    local below = tree:add(packet, tvb())
    below:add(sequence, tvb(2, 1))
    below:add(count, tvb(3, 2))
    pinfo.cols.protocol = "cannelloni"
    local at = HEADER
    for _ = 1, tvb(3, 2):uint() do
        local length, header, held = frame_at(tvb, at)
        if not length then
            break
        end
        if header == FRAME_HEADER and length <= 8 then
            hand_over(tvb, at, length, header, held, pinfo, tree)
        else
            below:add(tvb(at, header + held), "CAN FD frame")
        end
        at = at + header + held
    end
    if at ~= tvb:len() then
        below:add_proto_expert_info(no_end)
    end
    return tvb:len()
end

for port = 20000, 20003 do
    DissectorTable.get("udp.port"):add(port, packet)
end
