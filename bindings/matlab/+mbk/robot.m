function [result, info] = robot(what, varargin)
% mbk.robot  Subcommands of 'mbk robot': identify, force, check, describe, workspace.
%
%   [RESULT, INFO] = mbk.robot('identify', ..., NAME, VALUE, ...) runs 'mbk robot identify'. After the name of the
%   subcommand come data (see 'help mbk.measure'), file names or other words, as a text or a cell array of several,
%   then options with their values. RESULT is the document of --json as a struct, or the text that the command prints.
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run(['robot ' char(what)], varargin);
end
