function [data, words, documents, rest] = take_data(inputs)
% Data before the options: names of files; time, position, force and so on as arrays; a struct, table, timetable or
% iddata; or what a function of mbk gave as its second output. rest: the options.
  data = struct('signals', [], 'metadata', {{}}, 'events', []);
  words = {};
  documents = {};
  rest = inputs;
  if isempty(inputs)
    return
  end
  first = inputs{1};
  if is_text(first)
    words = {char(first)};
    rest = inputs(2:end);
  elseif iscell(first) || isa(first, 'string')
    words = cell(1, numel(first));
    for k = 1:numel(first)
      if iscell(first)
        words{k} = char(first{k});
      else
        words{k} = char(first(k));
      end
    end
    rest = inputs(2:end);
  elseif isnumeric(first)
    count = 1;
    while count < numel(inputs) && isnumeric(inputs{count + 1})
      count = count + 1;
    end
    data.signals = of_arrays(inputs(1:count));
    rest = inputs(count + 1:end);
  else
    [data, documents] = of_one(data, first);
    rest = inputs(2:end);
    while ~isempty(rest) && isempty(data.signals) && is_document(rest{1})
      documents{end + 1} = rest{1}.text;
      rest = rest(2:end);
    end
  end
end

function yes = is_text(value)
  yes = ischar(value) || (isa(value, 'string') && numel(value) == 1);
end

function yes = is_document(value)
  yes = isstruct(value) && isfield(value, 'text') && isfield(value, 'exit_code');
end

function signals = of_arrays(arrays)
% (logs), or (t, x, F), (t, x, F, xr), (t, x, F, xr, a): columns, one for each axis.
  signals = struct('name', {}, 'unit', {}, 'values', {});
  if numel(arrays) == 1
    signals = added(signals, 'logs', '', arrays{1});
    return
  end
  if numel(arrays) < 3 || numel(arrays) > 5
    error('mbk:usage', 'give time, position and force, then perhaps reference and acceleration');
  end
  t = arrays{1};
  signals = added(signals, 'time', 's', t(:));
  axes = min(size(arrays{2}));
  if axes == 1
    names = {{'x'}, {'F'}, {'xr'}, {'a'}};
  elseif axes == 2
    names = {{'x', 'y'}, {'Fx', 'Fy'}, {'xr', 'yr'}, {'ax', 'ay'}};
  else
    error('mbk:usage', 'position has %d columns: it has one for each axis, 1 or 2', axes);
  end
  for k = 2:numel(arrays)
    columns = arrays{k};
    if isvector(columns)
      columns = columns(:);
    end
    if size(columns, 2) ~= axes || size(columns, 1) ~= numel(t)
      error('mbk:usage', 'input %d is %d x %d, and with %d samples of %d axes it is %d x %d', k, size(columns, 1), ...
            size(columns, 2), numel(t), axes, numel(t), axes);
    end
    for axis = 1:axes
      signals = added(signals, names{k - 1}{axis}, '', columns(:, axis));
    end
  end
end

function [data, documents] = of_one(data, given)
  documents = {};
  if is_document(given)
    documents = {given.text};
  elseif isa(given, 'timetable')
    data.signals = of_timetable(given);
  elseif isa(given, 'table')
    data.signals = of_columns(empty_signals(), given, given.Properties.VariableNames, given.Properties.VariableUnits);
  elseif isa(given, 'iddata') || (isstruct(given) && isfield(given, 'OutputData') && isfield(given, 'InputData'))
    data.signals = of_iddata(given);
  elseif isstruct(given) && numel(given) == 1
    data = of_struct(data, given);
  else
    error('mbk:usage', 'data of class %s: give names of files, arrays, a struct, a table, a timetable or iddata', ...
          class(given));
  end
end

function signals = empty_signals()
  signals = struct('name', {}, 'unit', {}, 'values', {});
end

function data = of_struct(data, given)
% Fields are signals; beside them may stand units, metadata and events, as mbk.read gives them.
  signals = empty_signals();
  names = fieldnames(given);
  for k = 1:numel(names)
    name = names{k};
    if strcmp(name, 'metadata')
      entries = given.metadata';
      data.metadata = entries(:)';
    elseif strcmp(name, 'events')
      data.events = given.events;
    elseif ~strcmp(name, 'units')
      unit = '';
      if isfield(given, 'units') && isfield(given.units, name)
        unit = given.units.(name);
      end
      signals = added(signals, name, unit, given.(name));
    end
  end
  data.signals = signals;
end

function signals = of_timetable(data)
  times = data.Properties.RowTimes;
  if isa(times, 'datetime')
    times = times - times(1);
  end
  signals = added(empty_signals(), 'time', 's', seconds(times));
  signals = of_columns(signals, data, data.Properties.VariableNames, data.Properties.VariableUnits);
end

function signals = of_columns(signals, data, names, units)
  for k = 1:numel(names)
    unit = '';
    if k <= numel(units)
      unit = units{k};
    end
    columns = data.(names{k});
    for c = 1:size(columns, 2)
      name = names{k};
      if size(columns, 2) > 1
        name = sprintf('%s_%d', name, c);
      end
      signals = added(signals, name, unit, columns(:, c));
    end
  end
end

function signals = of_iddata(data)
  outputs = data.OutputData;
  inputs = data.InputData;
  count = size(outputs, 1);
  start = 0;
  if isfield_or_property(data, 'Tstart') && ~isempty(data.Tstart)
    start = data.Tstart;
  end
  signals = added(empty_signals(), 'time', 's', start + (0:count - 1)' * data.Ts);
  signals = of_matrix(signals, outputs, data.OutputName, data, 'OutputUnit');
  signals = of_matrix(signals, inputs, data.InputName, data, 'InputUnit');
end

function yes = isfield_or_property(data, name)
  yes = (isstruct(data) && isfield(data, name)) || (isobject(data) && isprop(data, name));
end

function signals = of_matrix(signals, values, names, data, unit_name)
  if ~iscell(names)
    names = {names};
  end
  for c = 1:size(values, 2)
    unit = '';
    if isfield_or_property(data, unit_name) && numel(data.(unit_name)) >= c && iscell(data.(unit_name))
      unit = data.(unit_name){c};
    end
    signals = added(signals, names{c}, unit, values(:, c));
  end
end

function signals = added(signals, name, unit, values)
  if ~(isnumeric(values) || islogical(values)) || ~isreal(values)
    error('mbk:usage', '%s is of class %s: give real numbers', name, class(values));
  end
  signals(end + 1) = struct('name', char(name), 'unit', char(unit), 'values', full(double(values)));
end
